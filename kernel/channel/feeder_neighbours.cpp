// SPDX-License-Identifier: Apache-2.0
// Orders of a program to other processes, outside the cycle.
#include <algorithm>

#include "kernel/channel/feeder.hpp"

namespace servogate::channel {

void Feeder::order_process(const program::ProcessOrder& order, const program::Command& command) {
  using Action = program::ProcessOrder::Action;
  constexpr EventKind kKinds[] = {EventKind::process_start, EventKind::process_release,
                                  EventKind::process_restart, EventKind::process_wait};
  static_assert(static_cast<int>(Action::start) == 0 && static_cast<int>(Action::release) == 1 &&
                static_cast<int>(Action::restart) == 2 && static_cast<int>(Action::wait) == 3);
  if (order.action != Action::release && order.process > processes_)
    return fail(placed(no_such_process(order.process, processes_), command));
  Event e;
  e.number = static_cast<std::uint8_t>(std::max(order.process - 1, 0));
  if (order.action == Action::start)
    e.code = texts_.add_finding(placed(process_not_started(order.process, order.program), command));
  event(kKinds[static_cast<int>(order.action)], command, e);
  if (order.action == Action::start)
    wanted_.push_back({last_event_, order.process - 1, order.program,
                       placed(program_not_found(order.process, order.program), command)});
}

/// What a process_start at rest has asked for. A program that is not there ends the run at that place.
void Feeder::supply() {
  if (supplied_event_ == 0) return;
  const auto wanted = std::find_if(wanted_.begin(), wanted_.end(),
                                   [this](const Wanted& w) { return w.event == supplied_event_; });
  if (wanted == wanted_.end()) return;
  const Supply supplied = supplier_ ? supplier_(process_, wanted->process, wanted->name) : Supply::not_found;
  if (supplied == Supply::busy) return;
  if (supplied == Supply::not_found) {
    Event e;
    e.kind = EventKind::error;
    e.generation = generation_;
    e.line = wanted->missing.line;
    e.code = texts_.add_finding(wanted->missing);
    link_.at_once.push(e);
  }
  wanted_.erase(wanted);
  supplied_event_ = 0;
}

}  // namespace servogate::channel
