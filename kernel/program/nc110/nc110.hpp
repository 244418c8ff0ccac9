// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::nc110 {

/// The language of the controls NC-110, NC-200, NC-201, NC-202, NC-210, NC-220, NC-230, NC-301, NC-302,
/// NC-310 as a table (docs/dialects/nc110.md). Source: programmer's manual, version 2.1.
const Dialect& dialect();

/// Canned cycles G81-G86 and G89 (G84 for a floating holder). Source: specification A 10.
void cycle(Execution& run, const BlockWords& words);

/// The variables, functions and types of E parameters (expressions.cpp), and E in the place of a number.
Expressions expressions();
ParameterSet parameters();
bool parameter_for_number(BlockText& text, Value& value);
/// T3.12
void read_tool(BlockText& text, Word& word);

/// Blocks of assignments and of codes in brackets (assignments.cpp), and what reading alone says against
/// them.
void own_form(Execution& run);
bool own_form_waits(const Block& block);
LineMark mark(std::string_view line, std::size_t pos);
void judge(const Judgement& reading, const Block& block);

/// TMR in seconds; with G95 it counts revolutions of the spindle.
double dwell_seconds(const Execution& run);
/// A dwell of TMR that is asked for at `word` while TMR is 0.
void check_dwell(Execution& run, const Word& word);
void dwell(Execution& run, const Word& word);
/// M, S, T and H in a running profile.
void profile(const Execution& run, const BlockWords& words);

/// May not stand in one block (table 2.4 of the manual, incompatible when either direction says so).
bool conflict(int g1, int g2);

}  // namespace servogate::program::nc110
