// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::canopen {

/// Whether this control may begin to lead a bus. It listens first: whoever leads nodes is heard, and then
/// nothing is sent. Controls that start together hear nothing; so each then announces itself a few times,
/// under a number that it has drawn, and the smallest number leads. Who draws the number of another one draws
/// anew. Whoever still listens gives way to every announcement.
///
/// The identifier of an announcement is its number, and the data of all are the same: two that meet bit by
/// bit pass as one frame, without an error and unheard by both. Their moments are drawn, too, so that this
/// cannot happen to all of them. An announcement means nothing to any device.
///
/// Pure state on a clock that is given: hand over all frames that wait, then poll(); at least every 20 ms.
/// Everything is real-time safe.
class MasterClaim {
 public:
  enum class State : std::uint8_t {
    listening,
    announcing,
    leads,  ///< nobody else wants the bus
    led,    ///< somebody leads it
    late,   ///< another control starts, and is first
  };
  /// Identifiers of announcements: 6C0h to 6DFh, which the pre-defined connection set leaves free.
  static constexpr std::uint32_t kFirstCob = 0x6C0, kCobs = 32;
  static_assert((kCobs & (kCobs - 1)) == 0 && kFirstCob % kCobs == 0, "one filter passes them all");
  /// How long it announces itself, after listening.
  static constexpr image::Nanoseconds kAnnouncing = 400 * image::kMillisecond;

  /// `own_node`: that of the control's heartbeat; `listening`: how long it listens; `chance`: a random
  /// number.
  MasterClaim(NodeId own_node, image::Nanoseconds listening, std::uint64_t chance) noexcept;

  void begin(image::Nanoseconds now) noexcept;
  /// Every frame that was received.
  void on_frame(const image::CanFrame& frame) noexcept;
  /// Behind all frames that waited at `now`. Sends an announcement when one is due.
  State poll(image::Nanoseconds now, image::CanBus& bus) noexcept;
  State state() const noexcept { return state_; }

  /// Whether a frame is an announcement, of whichever control.
  static bool announces(const image::CanFrame& frame) noexcept;

 private:
  std::int64_t draw(std::int64_t least, std::int64_t end) noexcept;

  NodeId own_node_;
  image::Nanoseconds listening_;
  std::uint64_t chance_;
  std::int64_t number_;
  State state_ = State::listening;
  bool again_ = false;  ///< a number drawn anew has to be announced for the whole time
  image::Nanoseconds until_ = 0, next_ = 0, polled_ = 0;
  int said_ = 0;
};

}  // namespace servogate::canopen
