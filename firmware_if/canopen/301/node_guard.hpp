// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// The master's end of node guarding, for a device without a heartbeat: a remote request every guard time,
/// answered with state and a toggle bit. Silence for guard time times life time factor is a lost node.
/// Source: CiA 301, 7.2.8.2.2.1 "Node guarding protocol". real-time safe.
class NodeGuard {
 public:
  enum class Verdict : std::uint8_t {
    fine,
    wrong_toggle,  ///< an answer repeated or lost on the way; does not keep the node alive
  };

  /// `factor` at least 1.
  NodeGuard(NodeId node, image::Nanoseconds guard_time, std::uint8_t factor) noexcept
      : node_(node), guard_time_(guard_time), life_time_(guard_time * (factor ? factor : 1)) {}

  /// After the node's boot-up or start: the next answer has toggle 0, the first request goes out at once.
  void start(image::Nanoseconds now) noexcept {
    toggle_ = false;
    next_ = now;
    deadline_ = now + life_time_;
  }
  /// Sends the request that is due. True when a frame was given to the bus.
  bool poll(image::Nanoseconds now, image::CanBus& bus) noexcept {
    if (now < next_) return false;
    image::CanFrame request;
    request.id = cob::heartbeat(node_);
    request.remote = true;
    request.length = 1;
    if (!bus.send(request)) return false;
    next_ += guard_time_;
    if (next_ <= now) next_ = now + guard_time_;
    return true;
  }
  /// An answer of the node. One with the wrong toggle bit is told, and the next is expected to follow on it.
  Verdict on_answer(const image::CanFrame& frame, image::Nanoseconds now) noexcept {
    const bool toggle = frame.data[0] & 0x80;
    const bool right = toggle == toggle_;
    toggle_ = !toggle;
    if (!right) return Verdict::wrong_toggle;
    deadline_ = now + life_time_;
    return Verdict::fine;
  }
  bool lost(image::Nanoseconds now) const noexcept { return now > deadline_; }
  image::Nanoseconds life_time() const noexcept { return life_time_; }

 private:
  NodeId node_;
  image::Nanoseconds guard_time_, life_time_;
  image::Nanoseconds next_ = 0, deadline_ = 0;
  bool toggle_ = false;
};

}  // namespace servogate::canopen
