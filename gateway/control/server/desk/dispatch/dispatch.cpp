// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/dispatch.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "gateway/control/compose/simulated/played_input.hpp"
#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/refusal.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

constexpr double kKeepAlive_ms = 30.0;  ///< of the wall clock, between two keep-alives of a jog

std::string signed_number(double value) { return (value > 0.0 ? "+" : "") + text::number(value, 4); }

}  // namespace

Outcome Dispatch::run() {
  const ask::Command& command = question_.command;
  if (resident_.ending() && !ask::only_looks(command)) return fail(says::kEnding, {}, kAlarm);
  if (ask::of_plc(command)) return plc_.carry_out(command, question_.caller);
  return std::visit(
      [this](const auto& wanted) -> Outcome {
        if constexpr (requires { this->take(wanted); })
          return take(wanted);
        else
          return fail(says::kUnknown, {}, kWrongUse);  // urgent ones do not come here
      },
      command);
}

bool Dispatch::ask(RequestKind kind, int axis, double value, std::optional<image::Mode> mode, int process) {
  image::Request r;
  r.kind = kind;
  r.axis = static_cast<std::int8_t>(axis);
  r.process = static_cast<std::int8_t>(process >= 0 ? process : axis >= 0 ? process_of(axis) : 0);
  r.value = value;
  if (mode) r.mode = static_cast<std::int8_t>(*mode);
  return ask(r);
}

bool Dispatch::ask(image::Request r) {
  r.asker = question_.caller.asker;
  r.client = question_.caller.hand().client;
  image::Answer answer;
  switch (resident_.ask(r, answer, question_.asked())) {
    case RequestDesk::Outcome::silent:
      refusal_ = fail(says::kWithdrawn, {}, kInfrastructure);
      return false;
    case RequestDesk::Outcome::taken:
      refusal_ = fail(says::kLeftToCycle, {}, kInfrastructure);
      return false;
    case RequestDesk::Outcome::overtaken:
      refusal_ = fail(says::kOvertaken, {}, kAlarm);
      return false;
    case RequestDesk::Outcome::answered:
      break;
  }
  if (answer.refusal == 0) return true;
  refusal_ = refused_by_gate(answer, machine(), language_);
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  if (refusal == cycle::Refusal::not_powered || refusal == cycle::Refusal::emergency_stop)
    add_missing(refusal_);
  return false;
}

void Dispatch::add_missing(Reply& answer) {
  answer.missing = missing_now(resident_, language_);
  // The control has not looked at them yet, or they came on since the gate refused.
  if (answer.missing->empty()) answer.text += "\n  " + text::render(says::kComesOn, {}, language_);
  for (const MissingCondition& m : *answer.missing) answer.text += "\n  " + m.text + "\n    " + m.remedy;
}

int Dispatch::axis(const std::string& letter) {
  FormProblem problem;
  const int index = axis_of(machine(), letter, problem);
  if (index < 0) refusal_ = fail(*problem.entry, problem.arguments, kWrongUse);
  return index;
}

bool Dispatch::process_known(int process) {
  if (process >= 0 && process < resident_.processes()) return true;
  image::Answer answer;
  answer.refusal = static_cast<std::uint16_t>(cycle::Refusal::no_such_process);
  answer.value = process;
  refusal_ = refused_by_gate(answer, machine(), language_);
  return false;
}

bool Dispatch::unit_is_own(int axis, const std::string& said) {
  const machine::AxisConfig& a = axis_config(axis);
  if (said.empty() || said == a.unit()) return true;
  refusal_ = fail(says::kNotUnit, {said, a.letter, text::unit_words(a.unit())}, kWrongUse);
  return false;
}

Outcome Dispatch::take(const ask::Power&) {
  return ask(RequestKind::power, -1, 1.0) ? good(says::kPowerOn) : refusal_;  // off is urgent
}

Outcome Dispatch::take(const ask::Home& wanted) {
  std::uint32_t mask = 0;
  int process = -1;
  std::string names;
  for (const std::string& letter : wanted.axes) {
    const int index = axis(letter);
    if (index < 0) return refusal_;
    const std::uint32_t bit = 1u << index;
    if ((mask & bit) != 0) continue;
    mask |= bit;
    if (process < 0) process = process_of(index);
    names += (names.empty() ? "" : ", ") + axis_config(index).letter;
  }
  if (!ask(RequestKind::home, -1, mask, image::Mode::home, process)) return refusal_;
  return mask == 0 ? good(says::kHomingAll) : good(says::kHoming, {names});
}

Outcome Dispatch::take(const ask::Jog& wanted) {
  const double value = wanted.value;
  const int index = axis(wanted.axis);
  if (index < 0 || !unit_is_own(index, wanted.unit)) return refusal_;
  const machine::AxisConfig& a = axis_config(index);
  const double distance = a.diameter ? value / 2.0 : value;
  if (distance == 0.0) return fail(says::kNoDistance, {a.letter}, kWrongUse);
  const image::AxisImage& before = resident_.image().axes[static_cast<std::size_t>(index)];
  const double target = before.command + before.distance_to_go + distance;
  if (!ask(RequestKind::jog_increment, index, distance, image::Mode::manual)) return refusal_;
  const bool homed = resident_.image().axes[static_cast<std::size_t>(index)].homed;
  const double limit = std::clamp(target, a.travel_min, a.travel_max);
  if (homed && !a.endless() && std::abs(limit - target) > 1e-9)
    return good(says::kJogClipped,
                {a.letter, text::number(limit * (a.diameter ? 2.0 : 1.0), 4), text::unit_words(a.unit())});
  if (a.diameter) return good(says::kJogDiameter, {a.letter, signed_number(value), signed_number(distance)});
  return good(says::kJog, {a.letter, signed_number(value), text::unit_words(a.unit())});
}

Outcome Dispatch::take(const ask::JogContinuous& wanted) {
  const int index = axis(wanted.axis);
  if (index < 0 || !ask(RequestKind::jog_continuous, index, wanted.value, image::Mode::manual))
    return refusal_;
  return good(says::kJogs, {axis_config(index).letter, wanted.value > 0.0 ? "+" : "-"},
              JogBegun{index, question_.caller.hand(), kKeepAlive_ms});
}

Outcome Dispatch::take(const ask::Zero& wanted) {
  const double value = wanted.value;
  const int index = axis(wanted.axis);
  if (index < 0 || !unit_is_own(index, wanted.unit)) return refusal_;
  if (!ask(RequestKind::zero, index, value)) return refusal_;
  const Zeroed zeroed = resident_.zero(index, value);
  const machine::AxisConfig& a = axis_config(index);
  const Reply done = good(a.diameter ? says::kZeroDiameter : says::kZero,
                          {a.letter, text::number(value, 4), text::unit_words(a.unit()),
                           std::to_string(zeroed.origin), text::number(zeroed.place, 4)},
                          zeroed);
  return with_new_tables(done);
}

Outcome Dispatch::take(const ask::Override& wanted) {
  if (!ask(RequestKind::override_feed, -1, wanted.percent / 100.0, {}, wanted.process)) return refusal_;
  return good(says::kOverride, {text::number(wanted.percent, 1)});
}

Outcome Dispatch::take(const ask::Input& wanted) {
  const PlayedInput played = play_input(machine(), resident_.control().world(), wanted.point, wanted.value);
  if (played.outcome == PlayedInput::Outcome::done) return good(*played.entry, played.arguments);
  return fail(*played.entry, played.arguments,
              played.outcome == PlayedInput::Outcome::wrong ? kWrongUse : kAlarm);
}

Outcome Dispatch::take(const ask::SetPlace& wanted) {
  const auto place = image::parse_place(wanted.place);
  if (!place || place->packet != image::Packet::k) return fail(says::kNoPlace, {wanted.place}, kWrongUse);
  image::Request r;
  r.kind = RequestKind::set_place;
  r.packet = static_cast<std::uint8_t>(place->packet);
  r.format = static_cast<std::uint8_t>(place->format);
  r.index = place->index;
  r.length = static_cast<std::uint8_t>(place->length);
  r.value = wanted.value;
  return ask(r) ? good(says::kPlaceSet, {wanted.place, text::number(wanted.value)}) : refusal_;
}

Outcome dispatch(Resident& resident, PlcDesk& plc, const Question& question) {
  return Dispatch(resident, plc, question).run();
}

}  // namespace servogate::gateway
