// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/operator_script.hpp"

#include <algorithm>

#include "gateway/control/run/standstill.hpp"
#include "gateway/control/run/words/wait_words.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::gateway {

using image::ProcessImage;
using image::ProcessState;
using image::RequestKind;

namespace {
/// A button that has not been released for so long, with its input known, was pressed before anybody could
/// mean it.
constexpr image::Nanoseconds kReleased_ns = 200'000'000;
constexpr double kBootPatience_s = 15.0;
constexpr double kRestPatience_s = 10.0;
constexpr double kSettled_s = 0.5;  ///< what a stage brings about has begun by then
}  // namespace

bool fault_stands(const cycle::AlarmSnapshot& alarms) noexcept {
  const auto fault = [](const image::AlarmRecord& r) { return r.reaction > image::Reaction::warn; };
  return alarms.reaction > image::Reaction::warn ||
         std::any_of(alarms.records.begin(), alarms.records.begin() + alarms.count, fault);
}

OperatorScript::OperatorScript(Wishes wishes, Post post)
    : wishes_(std::move(wishes)),
      post_(std::move(post)),
      stage_(wishes_.wait_for_start ? Stage::button : Stage::power) {}

void OperatorScript::send(RequestKind kind, double value) {
  post_({.id = next_id_++, .asker = image::Asker::command_line, .kind = kind, .value = value});
}

void OperatorScript::send_in(image::Mode mode, RequestKind kind) {
  post_({.id = next_id_++,
         .asker = image::Asker::command_line,
         .kind = kind,
         .mode = static_cast<std::int8_t>(mode)});
}

double OperatorScript::in_stage(const ProcessImage& image) const {
  return static_cast<double>(image.now.t_ns - entered_ns_) * 1e-9;
}

void OperatorScript::enter(Stage stage, const ProcessImage& image) {
  stage_ = stage;
  entered_ns_ = image.now.t_ns;
  asked_ = false;
  last_refusal_ = {};
}

void OperatorScript::power_down(Outcome outcome, const ProcessImage& image) {
  outcome_ = outcome;
  ended_in_ = stage_;
  enter(Stage::power_off, image);
}

/// A program that has waited for somebody too long is stopped on the path, as by Ctrl-C.
void OperatorScript::give_up(const ProcessImage& image) {
  const image::Wait& wait = image.processes[0].wait;
  if (wishes_.patience_s <= 0.0 || !needs_somebody(wait.reason)) return;
  if (static_cast<double>(image.now.t_ns - wait.since_ns) * 1e-9 < wishes_.patience_s) return;
  given_up_ = wait;
  outcome_ = Outcome::waited;
  send(RequestKind::stop);
}

void OperatorScript::interrupt() { ++interrupts_; }

void OperatorScript::take(const image::Answer& answer) {
  if (answer.refusal == 0 || stage_ >= Stage::power_off || refusal_.refusal != 0) return;
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  if (refusal == cycle::Refusal::axis_moves || refusal == cycle::Refusal::not_powered ||
      refusal == cycle::Refusal::switching_off) {
    asked_ = stage_ == Stage::power;  // not quite at rest yet: ask again
    last_refusal_ = answer;
    return;
  }
  refusal_ = answer;
}

void OperatorScript::poll(const ProcessImage& image) {
  stop_where_interrupted();
  if (stage_ == Stage::done) return;
  if (stage_ == Stage::power_off) return switch_off(image);
  if (outcome_ != Outcome::under_way) {
    const ProcessState state = image.processes[0].state;
    const bool busy =
        state == ProcessState::running || state == ProcessState::held || state == ProcessState::waiting;
    if (standing(image) && !busy) power_down(outcome_, image);
    return;
  }
  if (refusal_.refusal != 0 && stage_ < Stage::running) return power_down(Outcome::refused, image);
  if (last_refusal_.refusal != 0 && !asked_ && in_stage(image) > kRestPatience_s) {
    refusal_ = last_refusal_;
    return power_down(Outcome::refused, image);
  }
  switch (stage_) {
    case Stage::button:
      return await_button(image);
    case Stage::power:
      return switch_on(image);
    case Stage::homing:
      return home(image);
    case Stage::start:
      return start(image);
    default:
      return follow(image);
  }
}

// Each interrupt acts once: the first stops on the path, a later one stops at once.
void OperatorScript::stop_where_interrupted() {
  if (interrupts_ > interrupts_done_ && stage_ < Stage::power_off) {
    ++interrupts_done_;
    send(RequestKind::stop);
    outcome_ = Outcome::stopped;
  }
  if (interrupts_ > interrupts_done_ && interrupts_done_ > 0) {
    ++interrupts_done_;
    send(RequestKind::quick_stop);
  }
}

bool OperatorScript::standing(const ProcessImage& image) const {
  for (std::size_t a = 0; a < wishes_.letters.size(); ++a)
    if (image.axes[a].moving) return false;
  return true;
}

bool OperatorScript::failed(const ProcessImage& image) const {
  return image.alarms_active > 0 && wishes_.fault();
}

template <class Good>
bool OperatorScript::missing(const ProcessImage& image, Good&& good) {
  waiting_for_.clear();
  for (std::size_t a = 0; a < wishes_.letters.size(); ++a)
    if (!good(image.axes[a], a)) waiting_for_.push_back(wishes_.letters[a]);
  return !waiting_for_.empty();
}

void OperatorScript::await_button(const ProcessImage& image) {
  const bool known =
      wishes_.start_source < 0 ||
      image.sources[static_cast<std::size_t>(wishes_.start_source)].quality == image::Quality::good;
  const bool pressed = wishes_.start_place && image.packets.bit(*wishes_.start_place);
  const image::Nanoseconds now = image.now.t_ns;
  if (known && pressed && released_ns_ >= 0 && now - released_ns_ >= kReleased_ns)
    return enter(Stage::power, image);
  if (!known || pressed)
    released_ns_ = -1;
  else if (released_ns_ < 0)
    released_ns_ = now;
}

void OperatorScript::switch_on(const ProcessImage& image) {
  const bool offline = missing(image, [](const image::AxisImage& a, std::size_t) { return a.drive.online; });
  if (!offline && !asked_) {
    asked_ = true;
    send(RequestKind::reset);
    send(RequestKind::power, 1.0);
    entered_ns_ = image.now.t_ns;
  }
  const bool off = missing(image, [](const image::AxisImage& a, std::size_t) { return a.enabled; });
  if (!off) return enter(Stage::homing, image);
  const bool alarm = asked_ && in_stage(image) > kSettled_s && failed(image);
  if (alarm || in_stage(image) > kBootPatience_s) power_down(Outcome::alarm, image);
}

void OperatorScript::home(const ProcessImage& image) {
  const bool busy = missing(
      image, [](const image::AxisImage& a, std::size_t) { return a.owner != image::AxisOwner::homing; });
  const bool open = missing(
      image, [&](const image::AxisImage& a, std::size_t i) { return a.homed || !wishes_.needs_homing[i]; });
  if (open && !asked_) {
    asked_ = true;
    send_in(image::Mode::home, RequestKind::home);
  }
  const bool stands = standing(image);
  if (!open && !busy && stands)
    return wishes_.program ? enter(Stage::start, image) : power_down(Outcome::finished, image);
  // A warning alone is no reason to give up, but an order that ended without its axes homed is.
  homing_begun_ = homing_begun_ || image.homing || busy;
  const bool over = homing_begun_ && !image.homing && !busy;
  const bool gave_up = stands && in_stage(image) > kSettled_s && (over || failed(image));
  if (gave_up || in_stage(image) > wishes_.homing_patience_s) power_down(Outcome::alarm, image);
}

void OperatorScript::start(const ProcessImage& image) {
  if (!asked_) {
    asked_ = true;
    send(RequestKind::override_feed, wishes_.override_ratio);
    if (wishes_.wait_for_start)
      send(RequestKind::mode, static_cast<double>(image::Mode::automatic));
    else
      send_in(image::Mode::automatic, RequestKind::start);
  }
  if (image.processes[0].state != ProcessState::idle) enter(Stage::running, image);
}

void OperatorScript::follow(const ProcessImage& image) {
  switch (image.processes[0].state) {
    case ProcessState::ended:
      return power_down(Outcome::finished, image);
    case ProcessState::stopped_by_alarm:
    case ProcessState::stopped:  // by the PLC: nobody else is there
      return power_down(Outcome::alarm, image);
    case ProcessState::idle:
      return power_down(Outcome::stopped, image);
    default:
      return give_up(image);
  }
}

void OperatorScript::switch_off(const ProcessImage& image) {
  if (!asked_ && standing(image)) {
    asked_ = true;
    send(RequestKind::power, 0.0);
  }
  const bool off = (asked_ && axes_off(image)) || in_stage(image) > kAxesOffPatience_s;
  const bool rest = spindles_rest(image) || in_stage(image) > kSpindlePatience_s;
  if (off && rest) stage_ = Stage::done;
}

}  // namespace servogate::gateway
