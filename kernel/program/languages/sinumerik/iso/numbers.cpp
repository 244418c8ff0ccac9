// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// Numbers without a point in standard notation (MD10884 = 0; specification 1.5, tables 1-1 and 2-1).
namespace servogate::program::sinumerik::iso {
namespace {

struct Factors {
  double linear, rotary, feed;
};

Factors factors_of(const Execution& run) {
  const State& state = run.state();
  const bool inch = state.modes.unit == Function::inch, finer = setting(run, "MD10886") == 1.0;
  const double finest = finer ? 0.1 : 1.0;
  Factors f{(inch ? 0.0001 : 0.001) * finest, 0.001 * finest, 1.0};
  const bool turns = run.machine().turns();
  const bool lead = turns && state.modes.motion == Function::thread;
  const double hole = value(state, own::hole);
  const bool taps = turns && bit(run, 9) && (hole == 84.0 || hole == 88.0);
  if (lead || (taps && state.modes.feed == Function::feed_revolution) ||
      (turns && bit(run, 8) && state.modes.feed == Function::feed_revolution))
    f.feed = inch ? 0.000001 : 0.0001;
  else if (state.modes.feed == Function::feed_revolution)
    f.feed = inch ? 0.0001 : 0.01;
  else if (state.modes.feed == Function::feed_minute && inch)
    f.feed = 0.01;
  return f;
}

}  // namespace

void scale_numbers(Execution& run, const BlockWords& words) {
  // Machine data last as long as the run: what every block asks for is looked up once.
  double& notation = value(run.state(), own::notation);
  if (notation == own::kNotationUnknown)
    notation = setting(run, "MD10884") != 0.0 ? own::kCalculator : own::kStandard;
  if (notation == own::kCalculator) return;
  if (words.instead == dwell) return;  // counts ms in X, U and P
  Block& block = run.block();
  std::optional<Factors> factors;
  for (std::size_t i = 0; i < block.count; ++i) {
    Word& word = block.words[i];
    if (word.value.fraction || word.value.expression != 0) continue;
    if (word.letter == 'K' && value(run.state(), own::hole) != 0.0) continue;  // repeats
    if (word.meaning != Meaning::axis && word.meaning != Meaning::centre_of &&
        word.meaning != Meaning::radius && word.meaning != Meaning::feed)
      continue;
    if (!factors) factors = factors_of(run);
    const Factors& f = *factors;
    switch (word.meaning) {
      case Meaning::axis:
        word.value.number *= word.axis >= 0 && run.machine().rotary(word.axis) ? f.rotary : f.linear;
        break;
      case Meaning::centre_of:
      case Meaning::radius:
        word.value.number *= f.linear;
        break;
      default:
        word.value.number *= f.feed;
        break;
    }
  }
}

}  // namespace servogate::program::sinumerik::iso
