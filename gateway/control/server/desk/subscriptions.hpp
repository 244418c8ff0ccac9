// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "gateway/control/compose/control.hpp"

namespace servogate::gateway {

/// Snapshots of a running machine for clients in this process: a page, a Modbus server, a scenario. Any thread,
/// outside the cycle.
class Subscriptions {
 public:
  /// Gets the image of a whole cycle and the alarms with it, on the thread of the subscriptions. One subscriber
  /// after the other is served: who takes long delays the others, and nobody else.
  using Seen = std::function<void(const image::ProcessImage&, const cycle::AlarmSnapshot&)>;

  explicit Subscriptions(Control& control);
  ~Subscriptions() { stop(); }
  Subscriptions(const Subscriptions&) = delete;

  void start();
  /// Ends the thread. Nobody is served any more.
  void stop();
  /// A snapshot at most every `period`, and none where no cycle has been since the last one; its number. Not
  /// from a subscriber.
  std::uint64_t subscribe(std::chrono::milliseconds period, Seen seen);
  /// Once this has returned the subscriber is not called any more. Not from a subscriber.
  void unsubscribe(std::uint64_t number);

 private:
  using Clock = std::chrono::steady_clock;
  struct Subscriber {
    std::chrono::milliseconds period;
    Seen seen;
    Clock::time_point due;
    std::int64_t cycle = -1;  ///< of the snapshot it got last
  };
  void run();
  void serve();
  Clock::time_point next_due() const;

  Control& control_;
  std::unique_ptr<image::ProcessImage> image_;
  std::unique_ptr<cycle::AlarmSnapshot> alarms_;
  std::mutex serving_;  ///< held while subscribers are called; taken before mutex_
  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::uint64_t, Subscriber> subscribers_;
  std::uint64_t last_ = 0;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace servogate::gateway
