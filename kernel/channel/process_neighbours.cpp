// SPDX-License-Identifier: Apache-2.0
// What a program orders of the programs in other processes: EXE, SND and WAI of the NC-110.
#include "kernel/channel/process.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::channel {

namespace {

using image::ProcessState;

bool under_way(ProcessState s) noexcept {
  return s == ProcessState::running || s == ProcessState::held || s == ProcessState::waiting;
}

/// Nobody is working in it by hand. Off: nothing was asked of it yet.
bool runs_programs(image::Mode mode) noexcept {
  return mode == image::Mode::automatic || mode == image::Mode::off;
}

}  // namespace

/// Waits until the other process is at rest, has it given the program, and asks the gate to start it.
bool Process::start_other(const Event& e, cycle::ProcessContext& c) noexcept {
  const auto ends = [&](std::int32_t finding) {
    raise(cycle::alarm::kProgramError, e, finding, 0.0, c);
    leave(ProcessState::stopped_by_alarm, c);
    return true;
  };
  stage_ = Stage::waiting;
  state_ = ProcessState::waiting;
  switch (start_other_) {
    case StartOther::none: {
      if (held_ || under_way(c.image.processes[e.number].state)) return false;
      if (!runs_programs(c.image.processes[e.number].mode)) return ends(e.code);
      programs_of_other_ = meeting_.programs(e.number);
      FeederOrder order;
      order.kind = FeederOrder::Kind::supply;
      order.generation = generation_;
      order.event = e.id;
      link_.orders.push(order);
      start_other_ = StartOther::loading;
      return false;
    }
    case StartOther::loading:
      if (meeting_.programs(e.number) != programs_of_other_) start_other_ = StartOther::wished;
      return false;
    case StartOther::wished:
      return runs_programs(c.image.processes[e.number].mode) ? false : ends(e.code);
    case StartOther::started:
      start_other_ = StartOther::none;
      return true;
    case StartOther::refused:
      return ends(e.code);
  }
  return true;
}

bool Process::wish(image::Request& request) noexcept {
  // What is held begins nothing, in no process.
  if (held_ || start_other_ != StartOther::wished) return false;
  request.asker = image::Asker::program;
  request.kind = image::RequestKind::start;
  request.process = static_cast<std::int8_t>(event_.number);
  request.mode = static_cast<std::int8_t>(image::Mode::automatic);
  return true;
}

void Process::answered(const image::Answer& answer) noexcept {
  start_other_ = answer.refusal == 0 ? StartOther::started : StartOther::refused;
}

bool Process::meet(const Event& e) noexcept {
  stage_ = Stage::waiting;
  state_ = ProcessState::waiting;
  if (held_) return false;
  return e.kind == EventKind::process_wait ? meeting_.wait(config_.index, e.number)
                                           : meeting_.send(config_.index, e.number);
}

void Process::forget_neighbours() noexcept {
  start_other_ = StartOther::none;
  meeting_.leave(config_.index);
}

}  // namespace servogate::channel
