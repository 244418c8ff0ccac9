// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/resident/work/workshop.hpp"

#include <utility>

namespace servogate::gateway {

void Workshop::take(Work work, Done done) {
  {
    const std::scoped_lock lock(mutex_);
    if (!end_) {
      orders_.push_back({std::move(work), std::move(done)});
      wake_.notify_one();
      return;
    }
  }
  done({});
}

void Workshop::cancel() { stop_.request_stop(); }

void Workshop::close() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Workshop::run() {
  for (;;) {
    Order order;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return end_ || !orders_.empty(); });
      if (orders_.empty()) return;
      order = std::move(orders_.front());
      orders_.pop_front();
    }
    Finish finish;
    if (!stop_.stop_requested()) {
      try {
        finish = order.work.run(stop_.get_token());
      } catch (const Cancelled&) {
      }
    }
    order.done(std::move(finish));
  }
}

}  // namespace servogate::gateway
