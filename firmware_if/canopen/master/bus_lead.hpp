// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Whether this control leads its bus. A bus does not give anybody his own frames back: whatever leads nodes
/// and is received comes from somebody else. Everything is real-time safe.
class BusLead {
 public:
  /// Whoever comes back listens for so long, at least, before it speaks: longer than any usual SYNC period.
  static constexpr image::Nanoseconds kLook = 50 * image::kMillisecond;
  /// So long after its last frame another master counts as one that is there.
  static constexpr image::Nanoseconds kThere = image::kSecond;

  BusLead(NodeId own_node, image::Nanoseconds cycle_ns) noexcept
      : own_node_(own_node), look_cycles_(kLook / cycle_ns + 1) {}

  /// This control did not run for so long that another one may have taken its place.
  void came_back(image::Nanoseconds away) noexcept {
    if (lost_) return;
    away_ = away;
    cycles_left_ = look_cycles_;
  }
  /// Nothing may be sent: it has just come back, or has lost the bus.
  bool silent() const noexcept { return lost_ || cycles_left_ > 0; }
  /// Another control has taken its place; that lasts.
  bool lost() const noexcept { return lost_; }
  image::Nanoseconds away() const noexcept { return away_; }
  bool other_there(image::Nanoseconds now) const noexcept { return other_known_ && now - other_ns_ < kThere; }
  /// Its frame that came last.
  const image::CanFrame& other() const noexcept { return other_; }

  /// True: somebody else leads nodes with this frame.
  bool on_frame(const image::CanFrame& frame, image::Nanoseconds now) noexcept {
    if (!leads_nodes(frame, own_node_)) return false;
    other_ = frame;
    other_ns_ = now;
    other_known_ = true;
    if (cycles_left_ > 0) lost_ = true;
    cycles_left_ = 0;
    return true;
  }
  /// Behind the frames of a cycle; `all`: nothing waits any more.
  void look_on(bool all) noexcept {
    if (cycles_left_ > 0 && all) --cycles_left_;
  }

 private:
  NodeId own_node_;
  image::Nanoseconds look_cycles_, cycles_left_ = 0;
  image::Nanoseconds away_ = 0, other_ns_ = 0;
  image::CanFrame other_;
  bool lost_ = false, other_known_ = false;
};

}  // namespace servogate::canopen
