// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "kernel/program/cycles/boring.hpp"
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program {
struct State;
}

namespace servogate::program::fenix {

/// The language of the control Fenix (lathes) as a table (docs/dialects/fenix.md). Source: programmer's
/// guide.
const Dialect& dialect();

/// R parameters stand from 1 to 100; the variables $a to $z behind them.
inline constexpr int kLastR = 100;
inline constexpr int kFirstLetter = 200;
/// What Source knows the cycle @n by; the subprogram Ln is n.
inline constexpr int kFirstCycle = 10'000;
/// File of the cycles that all programs of its folder can call (specification 17).
inline constexpr std::string_view kCycleFile = "cycles";

// statements.cpp; source: specification 2, 4, 5, 17
extern const WordRule kAssignR, kAssignVariable, kJump, kCall, kRepeat, kCycleHeader, kCycleEnd;
bool value_in_place_of_number(BlockText& text, Value& value);
LineMark mark(std::string_view line, std::size_t pos);
void judge(const Judgement& reading, const Block& block);
/// A G word that the table does not have: a cycle of the file.
void call_cycle(Execution& run, const BlockWords& words);
/// G4
void dwell(Execution& run, const BlockWords& words);

/// Places in State::own.
enum class Own {
  breaks,
  break_last,
  pass,
  pass_set,
  back,
  dwell,
  least_rpm,
  corners,                 ///< arguments of G851, NaN: a gap
  contour = corners + 16,  ///< of G852
  corners_set = contour + 12,
  contour_set,
};

// angles.cpp; source: specification 7
void take_line(Execution& run, BlockWords& words, const Word& word);
void take_arc(Execution& run, BlockWords& words, const Word& word);

// modes.cpp; source: specification 10, 11, 14, 15
/// As G67 and G68 left them.
ChipBreaking chips(const State& state);
void break_chips(Execution& run, BlockWords& words, const Word& word);
void keep_chips(Execution& run, BlockWords& words, const Word& word);
void cutting_speed(Execution& run, BlockWords& words, const Word& word);
void feed_per_minute(Execution& run, BlockWords& words, const Word& word);
void corrector_on(Execution& run, BlockWords& words, const Word& word);
void corrector_off(Execution& run, BlockWords& words, const Word& word);
/// P404, the clearance of cycles in mm, and P2622, by how many per cent the spindle may be off.
void clearance(Execution& run, double value, int index, int column);
void deviation(Execution& run, double value, int index, int column);
/// G30
void home(Execution& run, const BlockWords& words);
/// G15
void turn_spindle(Execution& run, const BlockWords& words);
/// Modes of the block hold for it alone, as with a motion (specification 3).
void as_motion(Execution& run, BlockWords& words, const Word& word);

// turning.cpp, holes.cpp, profiles.cpp, threads.cpp; source: specification 13, 17 to 21
void turning(Execution& run, const BlockWords& words);
void holes(Execution& run, const BlockWords& words);
/// G851 and G852 store, until a cycle of another group forgets it; G853 and G855 work.
void profile_corners(Execution& run, const BlockWords& words);
void profile_contour(Execution& run, const BlockWords& words);
void profile(Execution& run, const BlockWords& words);
void forget_profile(State& state);
void thread_once(Execution& run, const BlockWords& words);
void thread_passes(Execution& run, const BlockWords& words);

// expressions.cpp; source: specification 4
Expressions expressions();
ParameterSet parameters();
double system_value(const Execution& run, int number, int column);

}  // namespace servogate::program::fenix
