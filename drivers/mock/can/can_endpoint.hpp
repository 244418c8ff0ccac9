// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/image/frames/counted_frames.hpp"

namespace servogate::mock {

inline constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

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
    explicit Pending(const CanFrame& frame, std::uint16_t wire_bits, Nanoseconds from) noexcept;
    /// The same bits on the wire.
    bool same(const Pending& other) const noexcept;
    bool same(std::uint32_t other_key, const CanFrame& other) const noexcept;
    void fill(CanFrame& frame) const noexcept;

    Nanoseconds not_before;
    std::uint32_t key;  ///< arbitration_key()
    std::uint32_t id;
    std::array<std::uint8_t, 8> data;
    std::uint16_t bits;
    std::uint8_t length;
    bool extended, remote;
  };
  /// The mailbox with the frame that it offers now, nullptr: none.
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
  std::vector<Pending> pending_;  ///< what is offered first is the last; never grows beyond its reservation
  image::CountedFrames counted_;
  std::vector<CanFrame> received_;
  std::size_t head_ = 0, count_ = 0;
  bool connected_ = true;
  std::uint32_t transmit_errors_ = 0, receive_errors_ = 0;
  Nanoseconds recover_at_ = std::numeric_limits<Nanoseconds>::min();
  Nanoseconds suspended_until_ = 0;  ///< error-passive senders wait eight more bits
};

// What happens to every frame is here, for the segment to have it without a call.

inline CanSegment::Endpoint::Pending::Pending(const CanFrame& frame, std::uint16_t wire_bits,
                                              Nanoseconds from) noexcept
    : not_before(from),
      key(arbitration_key(frame)),
      id(frame.id),
      bits(wire_bits),
      length(frame.length),
      extended(frame.extended),
      remote(frame.remote) {
  std::copy_n(frame.data.begin(), data.size(), data.begin());
}

inline bool CanSegment::Endpoint::Pending::same(const Pending& other) const noexcept {
  if (key != other.key || length != other.length) return false;
  return remote || std::equal(data.begin(), data.begin() + length, other.data.begin());
}

inline bool CanSegment::Endpoint::Pending::same(std::uint32_t other_key,
                                                const CanFrame& other) const noexcept {
  if (key != other_key || length != other.length) return false;
  return remote || std::equal(data.begin(), data.begin() + length, other.data.begin());
}

inline void CanSegment::Endpoint::Pending::fill(CanFrame& frame) const noexcept {
  frame.id = id;
  frame.extended = extended;
  frame.remote = remote;
  frame.length = length;
  std::copy(data.begin(), data.end(), frame.data.begin());
  frame.wire_bits = bits;
  frame.timestamp_ns = 0;
}

inline Nanoseconds CanSegment::Endpoint::ready_at() const noexcept {
  if (pending_.empty() || !on_bus()) return kNever;
  Nanoseconds earliest = pending_.back().not_before;
  if (earliest > segment_.now_ && segment_.config_.priority_mailboxes)
    for (const Pending& p : pending_) earliest = std::min(earliest, p.not_before);
  return std::max(earliest, suspended_until_);
}

inline const CanSegment::Endpoint::Pending* CanSegment::Endpoint::offer() const noexcept {
  if (!on_bus() || suspended_until_ > segment_.now_) return nullptr;
  for (auto p = pending_.rbegin(); p != pending_.rend(); ++p) {
    if (p->not_before <= segment_.now_) return &*p;
    if (!segment_.config_.priority_mailboxes) break;
  }
  return nullptr;
}

inline void CanSegment::Endpoint::drop_pending(std::uint32_t key, const CanFrame& frame) noexcept {
  const auto same = [key, &frame](const Pending& p) { return p.same(key, frame); };
  if (!pending_.empty() && same(pending_.back())) {
    pending_.pop_back();
  } else if (const auto it = std::find_if(pending_.rbegin(), pending_.rend(), same); it != pending_.rend()) {
    pending_.erase(std::next(it).base());
  }
  if (pending_.empty()) segment_.waiting_ &= ~bit();
}

}  // namespace servogate::mock
