// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "gateway/control/server/resident/work/outcome.hpp"

namespace servogate::gateway {

/// A thread that does one work after the other, beside whoever answers clients.
class Workshop {
 public:
  /// What came of a work: empty when it was cancelled. Called by the workshop's thread.
  using Done = std::function<void(Finish)>;

  Workshop() : thread_([this] { run(); }) {}
  ~Workshop() { close(); }
  Workshop(const Workshop&) = delete;

  void take(Work work, Done done);
  /// The work under way is asked to end, and what waits, or comes from now on, is not begun.
  void cancel();
  /// Does what waits, and ends the thread.
  void close();

 private:
  struct Order {
    Work work;
    Done done;
  };
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Order> orders_;
  std::stop_source stop_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace servogate::gateway
