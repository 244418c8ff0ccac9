// SPDX-License-Identifier: Apache-2.0
// Taps, whose commands are one motion, and probes, behind which the path begins anew.
#include <cmath>
#include <utility>

#include "kernel/channel/feeder.hpp"
#include "kernel/channel/for_cycle.hpp"

namespace servogate::channel {

/// True: the command is part of a tap, or ends the program because it is none.
bool Feeder::take_tap(const program::Command& command) {
  switch (tap_.take(command, elements_, planner_.position())) {
    case TapCommands::Taken::no:
      return false;
    case TapCommands::Taken::wrong:
      fail(placed(tap_.flaw(), command));
      return true;
    case TapCommands::Taken::yes:
      if (const int axis = elements_.foreign_axis(command, position_); axis >= 0)
        refuse_foreign(axis, command);
      return true;
    case TapCommands::Taken::complete:
      tap();
      return true;
  }
  return true;
}

/// All ways of a tap are planned at once.
void Feeder::tap() {
  const path::Vector from = planner_.position();
  if (auto leaves = undrivable_tap(config_, axes_, from, tap_.legs()))
    return fail(placed(std::move(*leaves), tap_.legs().front().command));
  ways_.bar();
  planner_.rest();
  for (const TapCommands::Leg& leg : tap_.legs()) {
    path::Element element = leg.element;
    element.tag = tag(leg.command);
    if (!planner_.add(element)) return fail(placed(cannot_drive(planner_.last_flaw()), leg.command));
  }
  planner_.rest();
  tap_.clear();
}

/// Where it ends is not known before it has: nothing behind it is read until then.
void Feeder::probe(const program::Command& command) {
  event(EventKind::probe_arm, command, {});
  ways_.bar();
  const auto& probe = std::get<program::Probe>(command.what);
  measuring_ = {position_, probe.to, {}, probe.feed_mm_min};
  const path::Vector from = planner_.position();
  for (std::size_t i = 0; i < axes_.machine.size(); ++i)
    measuring_.from[static_cast<std::size_t>(axes_.machine[i])] = from[i];
  if (!move(command)) return;
  event(EventKind::probe_end, command, {});
  state_ = State::probing;
}

void Feeder::take_touch(const FeederOrder& order) {
  state_ = State::feeding;
  position_ = order.position;
  planner_.restart(elements_.path_position(position_));
  ways_.restart();
  measuring_.at = order.touched;
  touch_log_.put(measuring_);
  if (!touch_) return interpreter_->probed(order.touched);
  touch_->touched(order.touched[static_cast<std::size_t>(touch_->axis())]);
  touches_.put(generation_, *touch_);
}

}  // namespace servogate::channel
