// SPDX-License-Identifier: Apache-2.0
// Taps, whose commands are one motion, and probes, behind which the path begins anew.
#include <cmath>
#include <utility>

#include "kernel/channel/feeder.hpp"
#include "kernel/channel/for_cycle.hpp"

namespace servogate::channel {

/// A tap is three commands: the way in, the spindle reversed, the way out. True: the command is part of one.
bool Feeder::take_tap(const program::Command& command) {
  const auto* thread = std::get_if<program::Thread>(&command.what);
  const bool taps = thread != nullptr && thread->tap;
  if (!tap_) {
    if (taps) tap_ = command;
    return taps;
  }
  if (const auto* spindle = std::get_if<program::Spindle>(&command.what); spindle != nullptr && !tap_back_) {
    tap_back_ = *spindle;
    return true;
  }
  if (taps && tap_back_)
    tap_back(command);
  else
    fail(placed(tap_open(), command));
  return true;
}

/// Both ways are planned at once, behind the event that says what the spindle does between them.
void Feeder::tap_back(const program::Command& command) {
  const program::Command in = *std::exchange(tap_, std::nullopt);
  if (const int axis = elements_.foreign_axis(in, position_); axis >= 0) return refuse_foreign(axis, in);
  const program::Spindle back = *std::exchange(tap_back_, std::nullopt);
  Event e;
  e.number = back.number;
  e.mode = back.mode;
  e.value = back.speed;
  event(EventKind::tap, in, e);
  ways_.bar();
  const path::Vector from = planner_.position();
  path::Element way_in = elements_.element(in, from);
  way_in.tag = tag(in);
  elements_.take(back);
  path::Element way_out = elements_.element(command, way_in.to);
  way_out.tag = tag(command);
  way_out.lock.kind = path::Lock::Kind::tap_out;
  constexpr double kSamePlace = 1e-6;  // mm
  for (std::size_t i = 0; i < from.size(); ++i)
    if (std::abs(way_out.to[i] - from[i]) > kSamePlace) return fail(placed(tap_open(), command));
  way_out.to = from;
  if (!planner_.add(way_in) || !planner_.add(way_out))
    return fail(placed(cannot_drive(planner_.last_flaw()), command));
  planner_.rest();
}

/// Where it ends is not known before it has: nothing behind it is read until then.
void Feeder::probe(const program::Command& command) {
  event(EventKind::probe_arm, command, {});
  ways_.bar();
  if (!move(command)) return;
  event(EventKind::probe_end, command, {});
  state_ = State::probing;
}

void Feeder::take_touch(const FeederOrder& order) {
  state_ = State::feeding;
  position_ = order.position;
  planner_.restart(elements_.path_position(position_));
  ways_.restart();
  interpreter_->probed(order.touched);
}

}  // namespace servogate::channel
