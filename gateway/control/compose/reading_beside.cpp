// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/reading_beside.hpp"

#include <algorithm>
#include <utility>

namespace servogate::gateway {
namespace {

constexpr double kLongest_s = 2.0;

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
      period_s_(static_cast<double>(period_ns) * 1e-9),
      round_([this] {
        const std::scoped_lock lock(reading_);
        for (const auto& process : processes_) process->work_beside(round_s_);
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

void ReadingBeside::begin_round(std::int64_t cycle) {
  round_s_ = kLongest_s;
  for (const auto& process : processes_)
    if (process->reading() == channel::Reading::beside) round_s_ = std::min(round_s_, process->spare());
  for (const auto& process : processes_) process->begin_beside();
  ends_ = cycle + std::max(std::int64_t{1}, static_cast<std::int64_t>(round_s_ / period_s_));
  under_way_ = true;
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
        begin_round(cycle);
    }
  }
  worker_->start(round_);
}

}  // namespace servogate::gateway
