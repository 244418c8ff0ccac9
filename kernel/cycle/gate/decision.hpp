// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/cycle/alarm/alarms.hpp"
#include "kernel/cycle/gate/gate.hpp"
#include "kernel/cycle/gate/request_kinds.hpp"

/// The gate's own: how a decision comes to be. gate.cpp has the requests, gate_beside.cpp those beside a held
/// program. real-time safe.
namespace servogate::cycle::decision {

using axis::Axis;
using image::Answer;
using image::Asker;
using image::AxisOwner;
using image::Mode;
using image::ProcessState;
using image::Reaction;
using image::Request;
using image::RequestKind;
using requests::kBegins;
using requests::kOfProcess;
using requests::kStops;
using requests::kTakesAway;
using requests::kTakesAwayAtZero;
using requests::kWithMode;
using requests::may_ask;

/// One decision under way: the first refusal stands.
class Decision {
 public:
  Decision(const Request& request, const GateContext& context) noexcept : r_(request), c_(context) {
    answer_.id = request.id;
  }
  Answer run() noexcept;

 private:
  bool refuse(Refusal why, int axis = -1, double value = 0.0, double limit = 0.0) noexcept {
    answer_.refusal = static_cast<std::uint16_t>(why);
    answer_.axis = static_cast<std::int8_t>(axis);
    answer_.value = value;
    answer_.limit = limit;
    return false;
  }
  ProcessState state(int process) const noexcept {
    return c_.image->processes[static_cast<std::size_t>(process)].state;
  }
  static bool busy(ProcessState s) noexcept {
    return s == ProcessState::running || s == ProcessState::held || s == ProcessState::waiting;
  }
  bool axis_known() noexcept {
    return (r_.axis >= 0 && r_.axis < std::ssize(c_.axes)) || refuse(Refusal::no_such_axis, -1, r_.axis);
  }
  bool process_known() noexcept {
    const bool needed = kOfProcess.has(r_.kind) || r_.mode >= 0 || c_.image->process_count > 0;
    if (r_.process == -1 && kStops.has(r_.kind)) return true;  // all of them, as many as there are
    return !needed || (r_.process >= 0 && r_.process < c_.image->process_count) ||
           refuse(Refusal::no_such_process, -1, r_.process);
  }
  bool no_alarm(Reaction from) noexcept {
    if (c_.reaction < from) return true;
    if (c_.first_alarm == alarm::kEmergencyStop) return refuse(Refusal::emergency_stop);
    return refuse(Refusal::alarm_active, -1, c_.first_alarm);
  }
  bool no_program() noexcept {
    for (int p = 0; p < c_.image->process_count; ++p)
      if (!no_program_of(p)) return false;
    return true;
  }
  bool no_program_of(int process) noexcept {
    return process >= c_.image->process_count || !busy(state(process)) || under_way(process);
  }
  /// What is said of a program that runs, or stops just now.
  bool under_way(int process) noexcept {
    const bool stops = (c_.stopping >> process & 1u) != 0;
    return refuse(stops ? Refusal::program_stopping : Refusal::program_runs, -1, process);
  }
  bool no_homing() noexcept { return !c_.homing_runs || refuse(Refusal::homing_runs); }
  bool not_held_by_another() noexcept {
    return !c_.manual_held || c_.holder == r_.asker ||
           refuse(Refusal::manual_held, -1, static_cast<double>(c_.holder));
  }
  bool ready(const Axis& a) noexcept {
    if (a.asleep()) return refuse(Refusal::axis_is_spindle, a.index());
    if (a.motion_permitted()) return feed_enabled(a);
    // While one of them is being switched off, none can be switched on: that comes first.
    for (const Axis& b : c_.axes)
      if ((&b == &a || !a.config().auxiliary) && !not_switching_off(b)) return false;
    return refuse(Refusal::not_powered, a.index());
  }
  bool feed_enabled(const Axis& a) noexcept {
    return a.feed_enabled() || refuse(Refusal::feed_not_enabled, a.index());
  }
  bool free(const Axis& a) noexcept {
    const AxisOwner o = a.owner();
    if (a.geared()) return refuse(Refusal::axis_geared, a.index());
    const bool own = (o == AxisOwner::plc && r_.asker == Asker::plc) ||
                     (o == AxisOwner::bench && r_.asker == Asker::bench);
    if (a.config().auxiliary && r_.asker != Asker::plc)
      return refuse(Refusal::axis_owned, a.index(), static_cast<double>(AxisOwner::plc));
    const bool others = o == AxisOwner::plc || o == AxisOwner::bench;
    return !others || own || refuse(Refusal::axis_owned, a.index(), static_cast<double>(o));
  }
  bool all_at_rest() noexcept {
    for (const Axis& a : c_.axes)
      if (a.moving()) return refuse(Refusal::axis_moves, a.index());
    return true;
  }
  /// The axis is one that the programs of the request's process move now.
  bool of_process(const Axis& a) const noexcept {
    return !a.config().auxiliary && !a.geared() && a.process() == r_.process;
  }
  bool power() noexcept;
  bool not_switching_off(const Axis& a) noexcept;
  bool home() noexcept;
  bool jog() noexcept;
  bool jog_beside(const Axis& a) noexcept;
  bool process_stands() noexcept;
  bool reposition() noexcept;
  bool retrace() noexcept;
  bool along_path() noexcept;
  bool function() noexcept;
  bool path_wheel() noexcept;
  bool gear() noexcept;
  bool gear_can_follow(const Axis& a) noexcept;
  bool as_it_was_held() noexcept;
  bool auxiliary() noexcept;
  bool move(const Axis& a) noexcept;
  bool torque(const Axis& a) noexcept;
  bool inside_travel(const Axis& a) noexcept;
  bool in_own_hand(const Axis& a) noexcept;
  bool keep_alive() noexcept;
  bool logic_scan() noexcept;
  bool drives_off() noexcept;
  bool zero() noexcept;
  bool assign() noexcept;
  bool tables() noexcept;
  bool mode() noexcept;
  bool mode_of_request() noexcept;
  image::Mode mode_in_force() const noexcept {
    return r_.mode >= 0 ? static_cast<Mode>(r_.mode)
                        : c_.image->processes[static_cast<std::size_t>(r_.process)].mode;
  }
  bool start() noexcept;
  bool step() noexcept;
  bool goes_on() const noexcept;
  bool runs_on() const noexcept;
  bool resume() noexcept;
  bool place(bool write) noexcept;
  bool not_of_emergency_stop(const image::Place& place) noexcept;
  bool may_force(const image::Place& place) noexcept;
  bool at_standstill() noexcept;
  bool decide_kind() noexcept;

  const Request& r_;
  const GateContext& c_;
  Answer answer_;
};

}  // namespace servogate::cycle::decision
