// SPDX-License-Identifier: Apache-2.0
// Polygon turning: the second spindle follows the first one (specification 17).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kMostTurns = 9999;
constexpr double kLargestOverride = 1.25;  // of a spindle, by the PLC

/// P or Q: a whole number of turns other than 0.
int turns(const Execution& run, const BlockWords& words, char letter, int least) {
  const Word* word = find(run.block(), letter);
  if (word == nullptr)
    fail(Wrong::letter_missing, column(words), {g_word(run, words), std::string(1, letter)});
  const double number = run.numbers().resolve(word->value);
  if (number != std::floor(number) || number < least || number > kMostTurns || number == 0.0)
    fail(Wrong::letter_range, word->column,
         {g_word(run, words), std::string(1, letter), text::number(number),
          least < 0 ? "±1 ... ±" + std::to_string(kMostTurns) : "1 ... " + std::to_string(kMostTurns)});
  return static_cast<int>(number);
}

/// R in degrees, as the start angle of threads is written.
double phase(const Execution& run) {
  const Word* r = find(run.block(), 'R');
  if (r == nullptr) return 0.0;
  double angle = run.numbers().resolve(r->value);
  if (!r->value.fraction && setting(run, "MD10884") == 0.0) angle *= 0.001;
  if (!(std::abs(angle) < 360.0))
    fail(Fault::out_of_range, r->column, {"R", text::number(angle), "-359.999", "359.999"});
  return angle;
}

}  // namespace

/// n2 = n1 Q / P, and R ahead of that angle. What S asks for later is slowed down to what the second spindle
/// can follow.
void polygon(Execution& run, const BlockWords& words) {
  only(run, "PQR");
  SpindleCoupling coupling;
  coupling.on = true;
  coupling.leader = turns(run, words, 'P', 1);
  coupling.follower = turns(run, words, 'Q', -kMostTurns);
  coupling.phase_deg = phase(run);
  const double most = run.machine().coupled_max_rpm;
  if (most <= 0.0) fail(Wrong::polygon_spindle, column(words), {g_word(run, words)});
  const Modes& modes = run.state().modes;
  const double limit = run.state().motion.limit_rpm, fastest = run.machine().spindle_max_rpm;
  if (modes.cutting && limit <= 0.0) fail(Wrong::polygon_limit, column(words), {g_word(run, words)});
  const double ordered = modes.cutting ? limit : modes.speed;
  const double reached =
      fastest > 0.0 ? std::min(kLargestOverride * ordered, fastest) : kLargestOverride * ordered;
  const double asked = reached * std::abs(coupling.follower) / coupling.leader;
  if (asked > most)
    fail(Wrong::polygon_speed, column(words),
         {g_word(run, words), text::number(ordered), text::number(asked), text::number(most)});
  run.motion().end_profile();
  run.emit(coupling);
}

void polygon_off(Execution& run, const BlockWords&) {
  only(run, "");
  if (run.machine().coupled_max_rpm <= 0.0) return;
  run.motion().end_profile();
  run.emit(SpindleCoupling{});
}

}  // namespace servogate::program::sinumerik::iso
