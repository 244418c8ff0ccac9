// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::fenix {

/// The language of the control Fenix (lathes) as a table (docs/dialects/fenix.md). Source: programmer's
/// guide.
const Dialect& dialect();

/// R parameters stand from 1 to 100; the variables $a to $z behind them.
inline constexpr int kLastR = 100;
inline constexpr int kFirstLetter = 200;
/// What Source knows the cycle @n by; the subprogram Ln is n.
inline constexpr int kFirstCycle = 10'000;

// statements.cpp; source: specification 2, 4, 5, 17
extern const WordRule kAssignR, kAssignVariable, kJump, kCall, kRepeat, kCycleHeader, kCycleEnd;
bool value_in_place_of_number(BlockText& text, Value& value);
LineMark mark(std::string_view line, std::size_t pos);
void judge(const Judgement& reading, const Block& block);
/// A G word that the table does not have: a cycle of the file.
void call_cycle(Execution& run, const BlockWords& words);
/// G4
void dwell(Execution& run, const BlockWords& words);

// expressions.cpp; source: specification 4
Expressions expressions();
ParameterSet parameters();
double system_value(const Execution& run, int number, int column);

}  // namespace servogate::program::fenix
