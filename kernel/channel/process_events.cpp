// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/channel/alarms/master_alarms.hpp"
#include "kernel/channel/motion/surface_speed.hpp"
#include "kernel/channel/process.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::channel {

namespace {

using image::ProcessState;

constexpr image::Place kOptionalStop = image::field(image::kProcessFields, "optional_stop");
constexpr int kWarningsPerCycle = 4;

bool holds(double a, program::Wait::Compare compare, double b) noexcept {
  using C = program::Wait::Compare;
  switch (compare) {
    case C::eq:
      return a == b;
    case C::ne:
      return a != b;
    case C::lt:
      return a < b;
    case C::le:
      return a <= b;
    case C::gt:
      return a > b;
    case C::ge:
      return a >= b;
  }
  return false;
}

void write_place(const Event& e, image::Packets& packets) noexcept {
  if (e.length != 0)
    packets.set_characters(e.place, {e.characters.data(), e.length});
  else
    packets.set_number(e.place, e.value);
}

axis::SpindleMode spindle_mode(program::SpindleMode mode) noexcept {
  switch (mode) {
    case program::SpindleMode::cw:
      return axis::SpindleMode::cw;
    case program::SpindleMode::ccw:
      return axis::SpindleMode::ccw;
    case program::SpindleMode::orient:
      return axis::SpindleMode::orient;
    case program::SpindleMode::turn:
      return axis::SpindleMode::turn;
    default:
      return axis::SpindleMode::stop;
  }
}

}  // namespace

void Process::apply_at_once(cycle::ProcessContext& c) noexcept {
  int warnings = 0;
  while (at_once_read_ < at_once_end_) {
    const Event& e = link_.at_once[at_once_read_];
    if (running_) {
      if (e.kind == EventKind::error)
        execute(e, c);
      else if (e.kind != EventKind::warning)
        write_place(e, c.image.packets);
      else if (++warnings <= kWarningsPerCycle)
        raise(cycle::alarm::kProgramWarning, e, e.code, e.code2, c);
      else
        break;
    }
    link_.at_once.free_below(++at_once_read_);
  }
}

// True: the event is done and the path goes on.
bool Process::execute(const Event& e, cycle::ProcessContext& c) noexcept {
  const bool entered = stage_ == Stage::entered;
  const auto wait_for_operator = [&] {
    stage_ = Stage::waiting;
    state_ = ProcessState::waiting;
    return go_on_;
  };
  switch (e.kind) {
    case EventKind::m_function:
      return handshake(HandshakeWord::m, e.code, 0.0, e, c);
    case EventKind::h_function:
      return handshake(HandshakeWord::h, e.code, 0.0, e, c);
    case EventKind::tool:
      if (!handshake(HandshakeWord::t, e.code, e.code2, e, c)) return false;
      c.image.processes[static_cast<std::size_t>(config_.index)].tool = static_cast<std::uint16_t>(e.code);
      row_ = e.code2;
      probing_.forget();  // it may be put away
      return true;
    case EventKind::spindle:
      return order_spindle(e, c);
    case EventKind::dwell:
      stage_ = Stage::waiting;
      waited_s_ += seconds(c);
      return waited_s_ >= e.value;
    case EventKind::write:
      if (!c.image.packets.contains(e.place)) raise(cycle::alarm::kWriteRefused, e, e.value, 0.0, c);
      write_place(e, c.image.packets);
      return true;
    case EventKind::wait:
      stage_ = Stage::waiting;
      state_ = ProcessState::waiting;
      return holds(c.image.packets.number(e.place), e.compare, e.value);
    case EventKind::spindle_mark:
      return passes_mark(e, c);
    case EventKind::probe_arm:
      return arm_probe(e, c);
    case EventKind::probe_end:
      return miss_probe(e, c);
    case EventKind::message:
      c.image.processes[static_cast<std::size_t>(config_.index)].message = e.code;
      return true;
    case EventKind::warning:
      return true;
    case EventKind::sync: {
      link_.look(generation_, c.image);
      FeederOrder order;
      order.kind = FeederOrder::Kind::sync;
      order.generation = generation_;
      link_.orders.push(order);
      return true;
    }
    case EventKind::window:
      if (axis::Axis& a = c.axes[e.number]; a.process() == config_.index) a.set_in_position_window(e.value);
      return true;
    case EventKind::spindle_coupling:
      return couple_spindles(e, c);
    case EventKind::spindle_axis:
      return change_spindle(e, c);
    case EventKind::feed_override:
      override_effective_ = e.flag;
      return true;
    case EventKind::process_start:
      return start_other(e, c);
    case EventKind::process_release:
      released_.store(run_of_programs_, std::memory_order_relaxed);
      return true;
    case EventKind::process_restart:
    case EventKind::process_wait:
      return meet(e);
    case EventKind::optional_stop:
      if (entered && !c.image.packets.bit(image::at(kOptionalStop, base_))) return true;
      return wait_for_operator();
    case EventKind::block_end:
      return !block_by_block_ || wait_for_operator();
    case EventKind::stop:
      return wait_for_operator();
    case EventKind::error:
      raise(cycle::alarm::kProgramError, e, e.code, 0.0, c);
      leave(ProcessState::stopped_by_alarm, c);
      return true;
    case EventKind::end:
      if (!manual_data_) stop_spindles(c);  // a typed block leaves them as it set them
      leave(ProcessState::ended, c);
      return true;
  }
  return true;
}

bool Process::handshake(HandshakeWord word, std::int32_t code, double value, const Event& e,
                        cycle::ProcessContext& c) noexcept {
  constexpr image::AlarmNumber kTimeouts[] = {cycle::alarm::kMAckTimeout, cycle::alarm::kSAckTimeout,
                                              cycle::alarm::kTAckTimeout, cycle::alarm::kHAckTimeout};
  if (stage_ == Stage::entered) {
    handshake_.begin(word, code, value, config_.handshake_timeout_s);
    stage_ = Stage::handshaking;
    state_ = ProcessState::waiting;
  }
  switch (handshake_.step(c.image, base_, held_ && function_count_ == 0)) {
    case Handshake::State::done:
      return true;
    case Handshake::State::unknown:
      raise(cycle::alarm::kUnknownM, e, code, 0.0, c);
      return true;
    case Handshake::State::timed_out:
      raise(kTimeouts[static_cast<int>(word)], e, word == HandshakeWord::s ? value : code,
            config_.handshake_timeout_s, c);
      leave(ProcessState::stopped_by_alarm, c);
      return true;
    case Handshake::State::idle:
    case Handshake::State::waiting:
      break;
  }
  return false;
}

bool Process::order_spindle(const Event& e, cycle::ProcessContext& c) noexcept {
  axis::Spindle* told = this->spindle(e.number, c);
  if (told == nullptr) return true;
  axis::Spindle& spindle = *told;
  // What was typed has left it an axis, which it is not for a program: it is on its way back.
  if (!spindle.wants_axis() && !spindle.is_spindle()) return false;
  if (e.mode == program::SpindleMode::turn) {
    if (stage_ == Stage::entered) spindle_turned_ = false;
    surface_speed_ = 0.0;
    stage_ = Stage::waiting;
    if (spindle_turned_) return spindle.oriented();
    if (spindle.mode() == axis::SpindleMode::orient && !spindle.oriented()) return false;
    spindle.turn(e.angle, e.value);
    spindle_turned_ = true;
    return false;
  }
  if (stage_ == Stage::entered) {
    surface_spindle_ = e.number;
    surface_speed_ = e.flag ? e.value : 0.0;
    surface_limit_ = e.limit;
    surface_center_ = e.center;
    const axis::SpindleMode mode =
        e.mode == program::SpindleMode::keep ? spindle.mode() : spindle_mode(e.mode);
    spindle.order(mode, e.flag && e.value > 0.0 ? spindle.ordered_rpm() : e.value);
    surface_speed(c);
    const double before = std::exchange(last_speed_, e.value > 0.0 ? spindle.ordered_rpm() : 0.0);
    if (e.value <= 0.0 || last_speed_ == before) return true;
  }
  return handshake(HandshakeWord::s, 0, last_speed_, e, c);
}

axis::Spindle* Process::spindle(std::size_t n, const cycle::ProcessContext& c) const noexcept {
  for (axis::Spindle& s : c.spindles)
    if (s.config().process == config_.index && n-- == 0) return &s;
  return nullptr;
}

void Process::stop_spindles(cycle::ProcessContext& c) noexcept {
  for (axis::Spindle& s : c.spindles)
    if (s.config().process == config_.index) s.order(axis::SpindleMode::stop, 0.0);
  surface_speed_ = 0.0;
}

/// As long as the spindle turns by it: a typed G96 holds for the next block, and for jogging, too.
void Process::surface_speed(cycle::ProcessContext& c) noexcept {
  if (surface_speed_ <= 0.0 || config_.axes.surface_speed_axis < 0) return;
  axis::Spindle* turns = this->spindle(surface_spindle_, c);
  if (turns == nullptr) return;
  axis::Spindle& spindle = *turns;
  if (spindle.mode() != axis::SpindleMode::cw && spindle.mode() != axis::SpindleMode::ccw) return;
  const axis::Axis& axis = c.axes[static_cast<std::size_t>(config_.axes.surface_speed_axis)];
  if (!axis.homed()) return;
  const double x = axis.setpoint().x;
  const double rpm = surface_rpm(surface_speed_, x - surface_center_, surface_limit_);
  spindle.adjust(rpm);
}

}  // namespace servogate::channel
