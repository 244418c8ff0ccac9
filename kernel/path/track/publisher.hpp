// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "kernel/path/track/track.hpp"

namespace servogate::path {

/// The planner's end of the track: keeps what has no room there yet. Not real-time safe.
class Publisher final : public SpanSink, public CourseSink {
 public:
  explicit Publisher(Track& track) : track_(track) {}

  void put(const Piece& piece) override { pieces_.push_back(piece); }
  void put(const Span& span) override;
  void begin_course() override;
  void put(const Knot& knot) override;
  void put(const StopHint& stop) override { stops_.push_back(stop); }
  void extend(const CourseExtent& extent) override;
  /// A marker behind all that was put.
  void put(const Entry& marker) { entries_.push_back(marker); }

  /// Numbers of the next entry, piece, knot and stop that are put.
  Track::Begin next() const;
  /// Hands over what has room, pieces before the spans that lie on them.
  void work();
  /// False while something waits for room, or some seconds lie ahead of the motion.
  bool wants_more() const;
  /// Something waits for room.
  bool waits() const { return !entries_.empty(); }
  /// How much of what lies ahead of the motion is in the track, s; 0: nothing, or nobody knows. `driven`:
  /// Follower::driven().
  double ahead(std::optional<double> driven) const;
  /// Sum of the times of all that is final, s.
  double planned() const { return final_time_; }

 private:
  Track& track_;
  bool in_track(const Entry& entry) const;
  /// s, as knot.planned: where the stretch in motion ends, by what has been given back. nullopt: nothing lies
  /// ahead.
  std::optional<double> passed() const;

  std::deque<Piece> pieces_;
  std::deque<Knot> knots_;
  std::deque<StopHint> stops_;
  std::deque<Entry> entries_;
  Entry course_;                ///< that was begun last
  double course_begins_ = 0.0;  ///< s
  double final_time_ = 0.0;     ///< running sum up to the last span, s
  double shown_time_ = 0.0;     ///< the same of what is in the track
};

}  // namespace servogate::path
