// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/retained_keeper.hpp"

#include <chrono>
#include <utility>
#include <vector>

namespace servogate::gateway {

namespace {

constexpr std::chrono::milliseconds kPause{50};

const text::Entry kNotKept{"run.retained-not-kept", "the retained values of the PLC cannot be written: {0}",
                           "сохраняемые значения ПЛК не записываются: {0}"};

}  // namespace

RetainedKeeper::RetainedKeeper(Control& control, std::string folder, std::int64_t generation,
                               Announce announce)
    : control_(control), announce_(std::move(announce)), directory_(folder), generation_(generation) {
  if (control.logic() != nullptr && !folder.empty()) thread_ = std::thread([this] { keep(); });
}

RetainedKeeper::~RetainedKeeper() { close(); }

bool RetainedKeeper::write_changed() {
  const std::shared_ptr<const plc::LogicProgram> program = control_.logic()->program();
  const plc::RetainedMemory& memory = program->retained;
  const bool same = program == program_ && memory.version() == written_;
  const bool own = program->engine.retain_bytes() > 0;
  if (same || (own ? memory.version() == 0 : program->aside.empty())) return true;
  std::vector<std::uint8_t> bytes;
  const std::uint64_t version = memory.read(bytes);
  std::vector<plc::Retained> values = program->aside;
  for (plc::Retained& v : program->engine.retained(bytes)) values.push_back(std::move(v));
  machine::MachineState state;
  for (plc::Retained& v : values)
    state.retained.push_back({std::move(v.name), std::move(v.type), std::move(v.value)});
  state.retained_generation = generation_ + 1;
  std::string problem;
  if (!directory_.save(state, machine::StatePart::retained, problem)) {
    if (problem_.empty() && announce_) announce_(kNotKept, {problem});
    problem_ = problem;
    return false;
  }
  problem_.clear();
  ++generation_;
  written_ = version;
  program_ = program;
  return true;
}

void RetainedKeeper::keep() {
  std::unique_lock lock(mutex_);
  while (!end_) {
    lock.unlock();
    write_changed();
    lock.lock();
    wake_.wait_for(lock, kPause, [this] { return end_; });
  }
}

std::string RetainedKeeper::close() {
  if (!thread_.joinable()) return problem_;
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
  }
  wake_.notify_all();
  thread_.join();
  write_changed();
  return problem_;
}

}  // namespace servogate::gateway
