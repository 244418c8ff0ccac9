// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/subscriptions.hpp"

#include <algorithm>
#include <utility>

namespace servogate::gateway {

Subscriptions::Subscriptions(Control& control)
    : control_(control),
      image_(std::make_unique<image::ProcessImage>()),
      alarms_(std::make_unique<cycle::AlarmSnapshot>()) {}

void Subscriptions::start() {
  thread_ = std::thread([this] { run(); });
}

void Subscriptions::stop() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
    wake_.notify_one();
  }
  thread_.join();
}

std::uint64_t Subscriptions::subscribe(std::chrono::milliseconds period, Seen seen) {
  const std::scoped_lock lock(serving_, mutex_);
  subscribers_[++last_] = {std::max(period, std::chrono::milliseconds(1)), std::move(seen), Clock::now(), -1};
  wake_.notify_one();
  return last_;
}

void Subscriptions::unsubscribe(std::uint64_t number) {
  const std::scoped_lock lock(serving_, mutex_);
  subscribers_.erase(number);
}

Subscriptions::Clock::time_point Subscriptions::next_due() const {
  Clock::time_point next = Clock::time_point::max();
  for (const auto& [number, s] : subscribers_) next = std::min(next, s.due);
  return next;
}

/// With serving_ held: subscribers neither come nor go meanwhile.
void Subscriptions::serve() {
  const Clock::time_point now = Clock::now();
  bool read = false;
  for (auto& [number, s] : subscribers_) {
    if (s.due > now) continue;
    s.due = now + s.period;
    if (!std::exchange(read, true)) {
      control_.cycle().read(*image_);
      control_.cycle().read(*alarms_);
    }
    if (s.cycle == image_->now.number) continue;
    s.cycle = image_->now.number;
    s.seen(*image_, *alarms_);
  }
}

void Subscriptions::run() {
  std::unique_lock lock(mutex_);
  while (!end_) {
    lock.unlock();
    {
      const std::scoped_lock serving(serving_);
      serve();
    }
    lock.lock();
    if (end_) return;
    if (subscribers_.empty())
      wake_.wait(lock, [this] { return end_ || !subscribers_.empty(); });
    else
      wake_.wait_until(lock, next_due());
  }
}

}  // namespace servogate::gateway
