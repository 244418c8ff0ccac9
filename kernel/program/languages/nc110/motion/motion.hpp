// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::nc110 {

/// Canned cycles G81-G86 and G89 (G84 for a floating holder). Source: specification A 10.
void cycle(Execution& run, const BlockWords& words);

/// Motion blocks between BSP and ESP. Source: specification A 11.
void spline(Execution& run, const BlockWords& words);
/// E32 in a block that measures.
void read_result(BlockText& text, Word& word);
/// G72, G73, G74. Source: specification A 18.
void probe_point(Execution& run, const BlockWords& words);
void probe_hole(Execution& run, const BlockWords& words);
void probe_deviation(Execution& run, const BlockWords& words);
/// G33, G34. Source: specification A 12.1.
void thread(Execution& run, const BlockWords& words);

/// TMR in seconds; with G95 it counts revolutions of the spindle.
double dwell_seconds(const Execution& run);
/// A dwell of TMR that is asked for at `word` while TMR is 0.
void check_dwell(Execution& run, const Word& word);
void dwell(Execution& run, const Word& word);
/// M, S, T and H in a running profile.
void profile(const Execution& run, const BlockWords& words);

}  // namespace servogate::program::nc110
