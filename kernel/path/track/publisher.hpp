// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "kernel/path/track/track.hpp"

namespace servogate::path {

/// The planner's end of the track: keeps what has no room there yet. Not real-time safe.
class Publisher final : public SpanSink {
 public:
  explicit Publisher(Track& track) : track_(track) {}

  void put(const Piece& piece) override { pieces_.push_back(piece); }
  void put(const Span& span, bool revised, bool more) override;
  /// A marker behind all that was put.
  void put(const Entry& marker) { entries_.push_back(marker); }

  /// Numbers of the next entry and piece that are put.
  Track::Begin next() const;
  /// Hands over what has room, pieces before the spans that lie on them.
  void work();
  /// False while something waits for room, or two seconds lie ahead of the motion.
  bool wants_more() const;

 private:
  Track& track_;
  std::deque<Piece> pieces_;
  std::deque<Entry> entries_;
  double final_time_ = 0.0;  ///< running sum up to the last final span, s
};

}  // namespace servogate::path
