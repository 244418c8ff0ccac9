// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernel/cycle/executive.hpp"
#include "kernel/cycle/executive_queues.hpp"
#include "kernel/cycle/gate/guarded_places.hpp"
#include "kernel/cycle/gate/interface_places.hpp"
#include "kernel/cycle/gate/request_kinds.hpp"

namespace servogate::cycle {

using image::Request;
using image::RequestKind;

namespace {
constexpr int kLooksPerCycle = 2 * kRequestsPerCycle;  ///< at requests that may turn out to be none
}  // namespace

Claim Cycle::post_for(const Request& request, image::Nanoseconds lain_ns,
                      image::Nanoseconds limit_ns) noexcept {
  Queues& q = *queues_;
  const Claim claim = q.last_claim + 1 != 0 ? q.last_claim + 1 : 1;
  std::atomic<Claim>& open = q.open[claim % Queues::kMost];
  if (open.load(std::memory_order_acquire) != 0) return 0;  // so many are under way
  const bool ages = limit_ns != kForAnyTime;
  const Queues::Posted posted{request, claim, ages ? request_clock().now_ns() - lain_ns : 0, limit_ns};
  open.store(claim, std::memory_order_relaxed);
  if (!q.requests.try_enqueue(posted)) {
    open.store(0, std::memory_order_relaxed);
    return 0;
  }
  return q.last_claim = claim;
}

bool Cycle::withdraw(Claim claim) noexcept { return claim != 0 && queues_->take(claim); }

const image::Clock& Cycle::request_clock() const noexcept {
  return parts_.request_clock != nullptr ? *parts_.request_clock : queues_->wall;
}

/// The next request that is neither withdrawn nor too old; those are no inputs of the cycle.
bool Cycle::take_request(Request& request) noexcept {
  Queues::Posted posted;
  for (int n = 0; n < kLooksPerCycle && queues_->requests.try_dequeue(posted); ++n) {
    if (!queues_->take(posted.claim)) continue;
    request = posted.request;
    if (posted.limit_ns == kForAnyTime) return true;
    const image::Nanoseconds age = request_clock().now_ns() - posted.since_ns;
    if (age <= posted.limit_ns || never_too_old(request)) return true;
    image::Answer answer;
    answer.id = request.id;
    answer.refusal = static_cast<std::uint16_t>(Refusal::too_old);
    answer.value = static_cast<double>(age) / 1e6;
    answer.limit = static_cast<double>(posted.limit_ns) / 1e6;
    queues_->answers.try_enqueue(answer);
  }
  return false;
}

bool Cycle::take_answer(image::Answer& answer) noexcept { return queues_->answers.try_dequeue(answer); }

void Cycle::handle_requests() noexcept {
  for (int i = 0; i < inputs_.request_count; ++i) {
    const image::Answer answer = handle(inputs_.requests[static_cast<std::size_t>(i)]);
    queues_->answers.try_enqueue(answer);
  }
  handle_plc_requests();
  for (ProcessInCycle* process : parts_.processes)
    if (Request wish; process->wish(wish)) process->answered(handle(wish));
}

image::Answer Cycle::handle(const Request& request) noexcept {
  GateContext context;
  context.image = &image_;
  context.axes = axes_;
  context.spindles = spindles_;
  context.reaction = alarms_.reaction();
  if (const image::AlarmRecord* first = alarms_.first(); first != nullptr)
    context.first_alarm = first->number;
  const auto process = static_cast<std::size_t>(request.process);
  context.program_loaded = process < parts_.processes.size() && parts_.processes[process]->loaded();
  for (std::size_t p = 0; p < parts_.processes.size(); ++p)
    if (parts_.processes[p]->stopping()) context.stopping |= 1u << p;
  context.holding = process < parts_.processes.size() && parts_.processes[process]->holding();
  context.path_wheel = process < parts_.processes.size() && path_wheels_[process].declared();
  if (request.kind == RequestKind::gear) {
    context.gears = gears_of(request.axis);
    context.gear = gear_of(request.axis, request.value);
  }
  context.homing_runs = homing_.running();
  context.manual_held = manual_held_;
  context.holder = holder_;
  context.drives_wanted = power_request_;
  context.logic_held = logic_held_;
  if (request.axis >= 0 && request.axis < std::ssize(axes_)) {
    context.axis_stopping = plc_motion_[static_cast<std::size_t>(request.axis)].stopping();
    context.axis_error_stop = plc_motion_[static_cast<std::size_t>(request.axis)].error_stop();
  }
  if (const auto p = static_cast<std::size_t>(beside_process(request, axes_)); p < parts_.processes.size())
    context.beside = parts_.processes[p]->beside(this->context(static_cast<int>(p)));
  context.estop_place = parts_.estop_place ? &*parts_.estop_place : nullptr;
  image::Answer answer = decide(request, context);
  if (answer.refusal != 0) return answer;
  const bool with_mode = request.mode >= 0 && !keeps_mode(request, context);
  const image::Mode before = with_mode ? image_.processes[process].mode : image::Mode::off;
  if (with_mode) change_mode(request.process, static_cast<image::Mode>(request.mode));
  answer.refusal = static_cast<std::uint16_t>(carry_out(request));
  if (answer.refusal == 0) return answer;
  answer.axis = request.axis;
  for (const axis::Axis& a : axes_)
    if (answer.axis < 0 && !a.standstill()) answer.axis = static_cast<std::int8_t>(a.index());
  if (with_mode) change_mode(request.process, before);
  return answer;
}

void Cycle::change_mode(int process, image::Mode mode) noexcept {
  if (image_.processes[static_cast<std::size_t>(process)].mode == mode) return;
  Request request;
  request.kind = RequestKind::mode;
  request.process = static_cast<std::int8_t>(process);
  request.value = static_cast<double>(mode);
  ProcessContext c = context(process);
  parts_.processes[static_cast<std::size_t>(process)]->order(request, c);
}

// A force that stands is changed in its place; a new one needs room.
Refusal Cycle::write_place(const Request& request) noexcept {
  const image::Place place{static_cast<image::Packet>(request.packet),
                           static_cast<image::Format>(request.format), request.index, request.length};
  if (request.kind == RequestKind::set_place) {
    image_.packets.set_number(place, request.value);
    return Refusal::none;
  }
  const auto end = forced_.begin() + forced_count_;
  const auto found = std::find_if(forced_.begin(), end, [&](const Forced& f) { return f.place == place; });
  if (request.kind == RequestKind::release_force) {
    if (found != end) *found = forced_[static_cast<std::size_t>(--forced_count_)];
  } else if (found != end) {
    found->value = request.value;
  } else if (forced_count_ < static_cast<int>(forced_.size())) {
    forced_[static_cast<std::size_t>(forced_count_++)] = {place, request.value};
  } else {
    return Refusal::forces_full;
  }
  watch_forces();
  return Refusal::none;
}

/// As long as a guard is forced, whatever resets the alarms.
void Cycle::watch_forces() noexcept {
  const auto end = forced_.begin() + forced_count_;
  const GuardedMachine machine{image_.process_count, axes_, spindles_};
  if (std::any_of(forced_.begin(), end, [&](const Forced& f) { return guards_motion(f.place, machine); }))
    raise(alarm::kGuardForced);
  else
    alarms_.cause_gone(alarm::kGuardForced, -1);
}

Refusal Cycle::carry_out(const Request& request) noexcept {
  switch (request.kind) {
    case RequestKind::none:
    case RequestKind::tables:
      break;
    case RequestKind::power:
      switch_power(request);
      break;
    case RequestKind::home:
    case RequestKind::jog_increment:
    case RequestKind::jog_continuous:
      return carry_out_manual(request);
    case RequestKind::keep_alive:
      keep_alive(request);
      break;
    case RequestKind::jog_stop:
      stop_jogs(request);
      break;
    case RequestKind::quick_stop:
      raise(alarm::kOperatorQuickStop);
      break;
    case RequestKind::reset:
    case RequestKind::acknowledge:
      reset(request);
      break;
    case RequestKind::set_place:
    case RequestKind::force:
    case RequestKind::release_force:
      return write_place(request);
    case RequestKind::axis_power:
    case RequestKind::axis_home:
    case RequestKind::move_absolute:
    case RequestKind::move_relative:
    case RequestKind::move_velocity:
    case RequestKind::torque:
    case RequestKind::axis_stop:
    case RequestKind::axis_reset:
      return carry_out_motion(request, axes_[static_cast<std::size_t>(request.axis)]);
    case RequestKind::logic:
      return parts_.logic != nullptr && parts_.logic->order(request) ? Refusal::none
                                                                     : Refusal::logic_not_changed;
    case RequestKind::logic_scan:
      return hold_logic(request) ? Refusal::none : Refusal::logic_not_changed;
    case RequestKind::stop:
    case RequestKind::hold:
      return end_or_hold(request);
    case RequestKind::assign:
      axes_[static_cast<std::size_t>(request.axis)].assign(request.process);
      break;
    case RequestKind::zero:
    case RequestKind::mode:
    case RequestKind::start:
    case RequestKind::step:
    case RequestKind::resume:
    case RequestKind::override_feed:
    case RequestKind::function:
      return order(request.process, request);
    case RequestKind::reposition:
    case RequestKind::retrace:
      return along_path(request);
    case RequestKind::gear:
      return engage_gear(request) ? Refusal::none : Refusal::axis_moves;
    case RequestKind::path_wheel:
      path_wheels_[static_cast<std::size_t>(request.process)].take(request);
      break;
  }
  return Refusal::none;
}

void Cycle::switch_power(const Request& request) noexcept {
  power_request_ = request.value != 0.0;
  power_asker_ = request.asker;
  for (axis::Axis& a : axes_)
    if (!power_request_ || !a.config().auxiliary) a.request_power(power_request_);
}

/// Homing and jogs: whoever asks holds manual control until all stands.
Refusal Cycle::carry_out_manual(const Request& request) noexcept {
  const auto axis = static_cast<std::size_t>(request.axis < 0 ? 0 : request.axis);
  const auto process = static_cast<std::size_t>(axes_[axis].process());
  if (request.kind != RequestKind::home && process < parts_.processes.size()) {
    ProcessContext c = context(static_cast<int>(process));
    path_wheels_[process].let_go();
    parts_.processes[process]->leave_path(request.axis, c);
  }
  const bool begun = request.kind == RequestKind::home ? homing_.start(axes_, homing_mask(request, axes_))
                     : request.kind == RequestKind::jog_increment
                         ? axes_[axis].jog_increment(request.value)
                         : axes_[axis].jog_continuous(request.value < 0.0 ? -1 : 1, image_.now.t_ns);
  if (!begun) return Refusal::axis_moves;
  manual_held_ = true;
  holder_ = request.asker;
  if (request.axis >= 0) image_.axes[axis].hand = request.hand();
  return Refusal::none;
}

/// As a jog: whoever asks holds manual control until all stands.
Refusal Cycle::along_path(const Request& request) noexcept {
  const Refusal refusal = order(request.process, request);
  if (refusal != Refusal::none) return refusal;
  manual_held_ = true;
  holder_ = request.asker;
  return refusal;
}

Refusal Cycle::order(int process, const Request& request) noexcept {
  const auto p = static_cast<std::size_t>(process);
  const std::uint32_t run = image_.processes[p].run;
  ProcessContext c = context(process);
  if (requests::kLeads.has(request.kind)) path_wheels_[p].let_go();
  const bool done = parts_.processes[p]->order(request, c);
  if (image_.processes[p].run != run) alarms_.run_begins(process);
  return done ? Refusal::none : Refusal::axis_moves;
}

/// Whoever presses hold wants rest: jogs and homing, too, which nothing resumes.
Refusal Cycle::end_or_hold(const Request& request) noexcept {
  for (Handwheel& wheel : handwheels_) wheel.stop();
  stop_manual(request.kind == RequestKind::stop);
  if (parts_.processes.empty()) return Refusal::none;
  if (request.process >= 0) return order(request.process, request);
  Refusal refusal = Refusal::none;
  for (std::size_t p = 0; p < parts_.processes.size(); ++p)
    if (const Refusal late = order(static_cast<int>(p), request); late != Refusal::none) refusal = late;
  return refusal;
}

/// Alarms as far as their causes are gone; a reset ends what is under way, too.
void Cycle::reset(const Request& request) noexcept {
  const bool ends = request.kind == RequestKind::reset;
  if (ends) {
    for (Handwheel& wheel : handwheels_)
      if (wheel.moves()) wheel.stop();
    stop_manual(true);
  }
  for (axis::Axis& a : axes_) a.reset();
  for (axis::Spindle& s : spindles_) s.reset();
  alarms_.reset([this](const image::AlarmRecord& r) { return still_present(r); });
  watch_forces();
  for (std::size_t p = 0; ends && p < parts_.processes.size(); ++p) {
    ProcessContext c = context(static_cast<int>(p));
    path_wheels_[p].let_go();
    parts_.processes[p]->order(request, c);
  }
}

void Cycle::keep_alive(const Request& request) noexcept {
  for (axis::Axis& a : axes_)
    if (request.axis < 0 || request.axis == a.index()) keep_alive(a, request.hand());
}

/// The dead-man of a jog is its hand's: whoever else lives says nothing of it.
void Cycle::keep_alive(axis::Axis& a, const image::Hand& hand) noexcept {
  if (image_.axes[static_cast<std::size_t>(a.index())].hand == hand) a.keep_alive(image_.now.t_ns);
}

void Cycle::stop_jogs(const Request& request) noexcept {
  const bool silent = request.value == 1.0;
  for (axis::Axis& a : axes_) {
    const auto i = static_cast<std::size_t>(a.index());
    if (request.axis >= 0 && a.index() != request.axis) continue;
    if (silent && image_.axes[i].hand != request.hand()) continue;  // that hand's fell silent, not this one's
    a.jog_stop(silent ? image::JogEnd::silent : image::JogEnd::asked);
    if (request.asker != image::Asker::plc) handwheels_[i].stop();
  }
}

/// The alarm takes the power and the alive output, and keeps both away until the operator's reset.
bool Cycle::hold_logic(const Request& request) noexcept {
  if (parts_.logic == nullptr || !parts_.logic->order(request)) return false;
  logic_held_ = request.value != 0.0;
  if (request.value != 1.0) return true;
  raise(alarm::kPlcHeld);
  return true;
}

Refusal Cycle::carry_out_motion(const Request& request, axis::Axis& a) noexcept {
  const auto begun = [](bool yes) { return yes ? Refusal::none : Refusal::axis_moves; };
  axis::MotionLimits limits = a.config().limits;
  limits.velocity = request.velocity;
  if (request.acceleration > 0.0) limits.acceleration = request.acceleration;
  switch (request.kind) {
    case RequestKind::axis_power:
      a.request_power(request.value != 0.0);
      return Refusal::none;
    case RequestKind::axis_home:
      return begun(a.home());
    case RequestKind::move_absolute:
      return begun(a.plc_move_to(request.value, limits));
    case RequestKind::move_relative:
      return begun(a.plc_move_to(a.setpoint().x + request.value, limits));
    case RequestKind::move_velocity:
      return begun(a.plc_move_at(request.value > 0.0 ? 1 : -1, limits));
    case RequestKind::torque:
      return begun(a.plc_torque(request.value, request.acceleration, request.velocity));
    case RequestKind::axis_reset:
      a.reset();
      return Refusal::none;
    default:
      a.stop();
      return Refusal::none;
  }
}

void Cycle::stop_manual(bool with_plc) noexcept {
  homing_.abort(axes_);
  if (with_plc) disengage_gears(-1);
  for (axis::Axis& a : axes_)
    if (a.owner() == image::AxisOwner::manual || a.owner() == image::AxisOwner::homing ||
        (with_plc && a.owner() == image::AxisOwner::plc))
      a.stop();
}

void Cycle::handle_plc_requests() noexcept {
  const bool pressed = parts_.start_place && image_.packets.bit(*parts_.start_place);
  // The machine's one button is for all its processes; one without a program refuses it.
  for (std::size_t p = 0; pressed && !start_pressed_ && p < parts_.processes.size(); ++p) {
    Request request;
    request.asker = image::Asker::pendant;
    request.process = static_cast<std::int8_t>(p);
    request.kind = RequestKind::start;
    handle(request);
  }
  start_pressed_ = pressed;
  for (std::size_t p = 0; p < parts_.processes.size(); ++p) {
    const std::uint32_t base = image::process_base(static_cast<int>(p));
    const bool start = image_.packets.bit(image::at(places::kStart, base));
    const bool reset = image_.packets.bit(image::at(places::kReset, base));
    const auto now = static_cast<std::uint8_t>((start ? 1 : 0) | (reset ? 2 : 0));
    const auto rising = static_cast<std::uint8_t>(now & ~plc_edges_[p]);
    plc_edges_[p] = now;
    Request request;
    request.asker = image::Asker::plc;
    request.process = static_cast<std::int8_t>(p);
    if ((rising & 1) != 0) {
      request.kind = RequestKind::start;
      handle(request);
    }
    if ((rising & 2) != 0) {
      request.kind = RequestKind::reset;
      handle(request);
    }
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    jog_of_plc(axes_[i]);
    follow_handwheel(handwheels_[i], axes_[i]);
    follow_gear(gear_orders_[i], axes_[i]);
  }
  for (std::size_t p = 0; p < parts_.processes.size(); ++p) follow_path_wheel(path_wheels_[p]);
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (axes_[i].config().auxiliary) move_auxiliary(plc_motion_[i], axes_[i]);
}

void Cycle::jog_of_plc(axis::Axis& a) noexcept {
  std::int8_t& before = plc_jogs_[static_cast<std::size_t>(a.index())];
  const auto wish = static_cast<std::int8_t>(a.plc_jog());
  Request request;
  request.asker = image::Asker::plc;
  request.axis = static_cast<std::int8_t>(a.index());
  if (wish != before) {
    request.kind = wish == 0 ? RequestKind::jog_stop : RequestKind::jog_continuous;
    request.value = wish;
    handle(request);
  } else if (wish != 0) {
    keep_alive(a, request.hand());
  }
  before = wish;
}

void Cycle::follow_handwheel(Handwheel& wheel, axis::Axis& a) noexcept {
  wheel.read(image_, a.index());
  if (Request request; wheel.next(request, a)) wheel.answer(request, handle(request));
  wheel.write(image_);
}

void Cycle::follow_path_wheel(PathWheel& wheel) noexcept {
  wheel.read(image_);
  if (Request request; wheel.next(request, image_)) wheel.answer(request, handle(request));
  wheel.write(image_);
}

void Cycle::move_auxiliary(PlcMotion& motion, axis::Axis& a) noexcept {
  if (motion.resetting())
    alarms_.reset([this](const image::AlarmRecord& r) { return still_present(r); }, a.index());
  PlcMotion::Alarms alarms;
  alarms.stop = alarms_.reaction() >= image::Reaction::stop_on_path;
  if (const image::AlarmRecord* first = alarms_.first(); alarms.stop && first != nullptr)
    alarms.number = first->number;
  motion.read(image_, a.index());
  motion.watch(a, alarms, image_.now.period_s());
  for (Request request; motion.next(request, a);) motion.answer(request, handle(request), a);
  motion.write(image_, a);
}

}  // namespace servogate::cycle
