// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Heartbeat producer 1017h, heartbeat consumer 1016h, answers to node guarding and life guarding 100Ch/100Dh
/// of one device. Source: CiA 301, 7.2.8.2. real-time safe but for the constructor.
class NodeMonitor {
 public:
  static constexpr int kConsumers = 4;
  NodeMonitor(ObjectDictionary& dictionary, NodeId node);

  void connect(image::CanBus* bus) noexcept { bus_ = bus; }
  /// After a reset: the boot-up message, then the producer's period begins.
  void start(image::Nanoseconds now) noexcept;
  void stop() noexcept { running_ = false; }
  /// Another node-ID, by layer setting; before start().
  void set_node(NodeId node) noexcept { node_ = node; }
  /// 1017h was written.
  void producer_changed(image::Nanoseconds now) noexcept;
  /// 1016h:n was written.
  void consumer_changed(int n) noexcept { consumers_[static_cast<std::size_t>(n - 1)] = {}; }
  /// Whether 1016h:n may take this value: two entries for one node are refused (0604 0043h).
  AbortCode check_consumer(int n, std::uint32_t value) const noexcept;

  /// A heartbeat of somebody, or a remote request on our identifier.
  void on_frame(const image::CanFrame& frame, NmtState own_state, image::Nanoseconds now) noexcept;
  /// Sends heartbeats, watches the others. Every millisecond.
  void tick(NmtState own_state, image::Nanoseconds now) noexcept;

  /// A monitored node or the guarding master is silent.
  bool lost() const noexcept { return lost_; }

 private:
  struct Consumer {
    bool running = false;
    bool lost = false;
    image::Nanoseconds deadline = 0;
  };
  void send(std::uint8_t state) noexcept;
  void watch(image::Nanoseconds now) noexcept;

  NodeId node_;
  std::int64_t& producer_ms_;
  std::int64_t& guard_ms_;
  std::int64_t& life_factor_;
  std::array<std::int64_t*, kConsumers> entries_{};
  image::CanBus* bus_ = nullptr;
  bool running_ = false;
  image::Nanoseconds next_ = 0;
  std::array<Consumer, kConsumers> consumers_{};
  bool toggle_ = false;
  bool guarded_ = false;  ///< the first remote request has come
  bool guard_lost_ = false;
  image::Nanoseconds guard_deadline_ = 0;
  bool lost_ = false;
};

}  // namespace servogate::canopen
