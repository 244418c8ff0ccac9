// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"

namespace servogate::mock {

inline constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

/// Equal but for the identifier, which the caller has compared. real-time safe.
inline bool same_content(const CanFrame& a, const CanFrame& b) noexcept {
  if (a.length != b.length || a.remote != b.remote) return false;
  for (std::size_t i = 0, n = a.remote ? 0 : a.length; i < n; ++i)
    if (a.data[i] != b.data[i]) return false;
  return true;
}

/// One controller on a segment: its mailboxes, receive queue and error counters. Inside of CanSegment.
class CanSegment::Endpoint final : public image::CanBus {
 public:
  Endpoint(CanSegment& segment, int number, std::string name, CanNode* node)
      : segment_(segment),
        number_(number),
        name_(std::move(name)),
        node_(node),
        filter_(node != nullptr ? node->filter() : nullptr) {
    pending_.reserve(segment.config_.send_queue);
    if (!node) received_.resize(std::max<std::size_t>(1, segment.config_.receive_queue));
  }

  bool send(const CanFrame& frame) noexcept override;
  bool receive(CanFrame& frame) noexcept override;
  image::CanState state() const noexcept override;
  std::uint32_t bit_rate() const noexcept override { return segment_.config_.bit_rate; }

  /// Takes part in the traffic: plugged in, alive and not bus-off.
  bool on_bus() const noexcept { return connected_ && !bus_off() && (node_ == nullptr || node_->alive()); }
  bool bus_off() const noexcept { return segment_.now_ < recover_at_; }
  /// Earliest time at which it offers a frame; of what it offers already, some time until now.
  Nanoseconds ready_at() const noexcept;
  /// A frame in its mailbox, with its length counted.
  struct Pending {
    CanFrame frame;
    Nanoseconds not_before = 0;
    std::uint32_t key = 0;  ///< arbitration_key()
  };
  /// The frame it offers now, nullptr: none.
  const Pending* offer() const noexcept;
  /// Takes the frame that was on the wire out of its mailbox; nothing happens when it has gone meanwhile.
  void drop_pending(std::uint32_t key, const CanFrame& frame) noexcept;
  /// The controller's filter lets data frames of this identifier (11 bits) through to the node.
  bool accepts(std::uint32_t id) const noexcept { return filter_ == nullptr || (*filter_)[id]; }

  void push(const CanFrame& frame) noexcept;
  void sent() noexcept;
  void transmit_error(bool count) noexcept;
  void receive_error() noexcept {
    if (receive_errors_ < 128) ++receive_errors_;
  }
  bool hears_well() const noexcept { return receive_errors_ == 0; }
  void received_well() noexcept {
    if (receive_errors_ > 0) --receive_errors_;
  }
  void go_bus_off() noexcept;
  void recover() noexcept;

  CanNode* node() const noexcept { return node_; }
  Nanoseconds due() const noexcept { return due_; }
  void plan(Nanoseconds now) noexcept {
    due_ = std::max(node_->next_action_ns(), now + 1);
    segment_.node_due_known_ = false;
  }
  void set_connected(bool connected) noexcept;

 private:
  std::uint64_t bit() const noexcept { return std::uint64_t{1} << number_; }

  CanSegment& segment_;
  int number_;
  std::string name_;
  CanNode* node_;
  const CanFilter* filter_;
  Nanoseconds due_ = kNever;
  std::vector<Pending> pending_;  ///< in the order of send(); never grows beyond its reservation
  std::vector<CanFrame> received_;
  std::size_t head_ = 0, count_ = 0;
  bool connected_ = true;
  std::uint32_t transmit_errors_ = 0, receive_errors_ = 0;
  Nanoseconds recover_at_ = std::numeric_limits<Nanoseconds>::min();
  Nanoseconds suspended_until_ = 0;  ///< error-passive senders wait eight more bits
};

}  // namespace servogate::mock
