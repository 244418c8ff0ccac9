// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::sinumerik {

/// The language of the control SINUMERIK 808D in its own mode (G290) as a table
/// (docs/dialects/sinumerik-808d.md).
const Dialect& dialect();

inline constexpr int kRParameters = 300;

// statements.cpp: assignments, jumps, subprograms, messages
extern const WordRule kAssignR, kCallByNumber, kSystemVariable;
std::span<const WordRule> words();
bool value_in_place_of_number(BlockText& text, Value& value);
void judge(const Judgement& reading, const Block& block);
/// G4 F: seconds
void dwell(Execution& run, const BlockWords& words);

// frames.cpp: the programmable frame
void trans(Execution& run, const BlockWords& words);
void atrans(Execution& run, const BlockWords& words);
void rot(Execution& run, const BlockWords& words);
void arot(Execution& run, const BlockWords& words);

// expressions.cpp
/// Behind G70: feeds stay in mm. Behind G700 they are in inch, too.
void lengths_only(Execution& run, BlockWords& words, const Word& word);
void with_feeds(Execution& run, BlockWords& words, const Word& word);
/// Another unit of the feed: F has to be programmed anew.
void new_feed(Execution& run, BlockWords& words, const Word& word);
/// G601 and G602: which window of an axis ends an exact stop, from this block on.
void fine_stop(Execution& run, BlockWords& words, const Word& word);
void coarse_stop(Execution& run, BlockWords& words, const Word& word);
/// CFC, CFTCP and CFIN: what F is the speed of on an arc under radius compensation.
void feed_of_contour(Execution& run, const Word& word);
void feed_of_centre(Execution& run, const Word& word);
void feed_of_inside(Execution& run, const Word& word);

/// G291: the blocks behind it are read in the ISO dialect.
void to_iso(Execution& run, const BlockWords& words);

Expressions expressions();
ParameterSet parameters();

}  // namespace servogate::program::sinumerik
