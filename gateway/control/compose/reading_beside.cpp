// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/reading_beside.hpp"

#include <algorithm>
#include <utility>

namespace servogate::gateway {
namespace {

/// Planner::ample() allows for it.
constexpr image::Nanoseconds kRound_ns = 200 * image::kMillisecond;

}  // namespace

WorksBeside::~WorksBeside() {
  wait();
  state_.store(State::over, std::memory_order_release);
  state_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void WorksBeside::start(const std::function<void()>& work) {
  if (!thread_.joinable()) thread_ = std::thread([this] { live(); });
  work_ = &work;
  state_.store(State::working, std::memory_order_release);
  state_.notify_all();
}

void WorksBeside::wait() { state_.wait(State::working, std::memory_order_acquire); }

void WorksBeside::live() {
  for (;;) {
    state_.wait(State::idle, std::memory_order_acquire);
    if (state_.load(std::memory_order_acquire) == State::over) return;
    try {
      (*work_)();
    } catch (...) {
      failed_ = std::current_exception();
    }
    state_.store(State::idle, std::memory_order_release);
    state_.notify_all();
  }
}

void WorksBeside::rethrow() {
  if (failed_) std::rethrow_exception(std::exchange(failed_, nullptr));
}

std::unique_ptr<RoundWorker> round_worker() {
  if (std::thread::hardware_concurrency() > 1) return std::make_unique<WorksBeside>();
  return std::make_unique<WorksAtOnce>();
}

ReadingBeside::ReadingBeside(std::span<const std::unique_ptr<channel::Process>> processes,
                             std::mutex& reading, image::Nanoseconds period_ns,
                             std::unique_ptr<RoundWorker> worker)
    : processes_(processes),
      reading_(reading),
      round_cycles_(std::max<image::Nanoseconds>(1, kRound_ns / period_ns)),
      round_([this] {
        const std::scoped_lock lock(reading_);
        for (const auto& process : processes_) process->work_beside();
      }),
      worker_(std::move(worker)) {}

ReadingBeside::~ReadingBeside() { worker_->wait(); }

bool ReadingBeside::ordered() const {
  return std::any_of(processes_.begin(), processes_.end(),
                     [](const auto& process) { return process->feeder().ordered(); });
}

channel::Reading ReadingBeside::needed() const {
  channel::Reading most = channel::Reading::nothing;
  for (const auto& process : processes_) most = std::max(most, process->reading());
  return most;
}

void ReadingBeside::end_round() {
  worker_->wait();
  for (const auto& process : processes_) process->end_beside();
  under_way_ = false;
  worker_->rethrow();
}

void ReadingBeside::before_cycle(std::int64_t cycle) {
  if (under_way_) {
    if (cycle < ends_ && !ordered()) return;
    end_round();
  }
  {
    const std::scoped_lock lock(reading_);
    switch (needed()) {
      case channel::Reading::nothing:
        return;
      case channel::Reading::now:
        for (const auto& process : processes_) process->work();
        return;
      case channel::Reading::beside:
        for (const auto& process : processes_) process->begin_beside();
    }
  }
  under_way_ = true;
  ends_ = cycle + round_cycles_;
  worker_->start(round_);
}

}  // namespace servogate::gateway
