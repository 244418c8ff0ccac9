// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>

#include "kernel/path/law/motion.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {

/// How long a path takes at override 1. An element from rest to rest takes the law's time; of a course the
/// speeds are foretold (SpeedForecast), and so is its time: about. Threads and taps take the speed that their
/// lead is planned for. No cycle is stepped, so the cost goes with the path and not with the time it takes.
/// Waiting for the axes to be in position is not counted. Not real-time safe.
class PathTime final : private MomentSink {
 public:
  /// `look`: takes the path moment by moment, in its order.
  PathTime(const Config& config, const Vector& start, MomentSink* look = nullptr);
  PathTime(const PathTime&) = delete;
  PathTime& operator=(const PathTime&) = delete;

  /// Appends an element. False: it cannot be driven, last_flaw() says why, and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return planner_.last_flaw(); }
  /// The path comes to rest behind the elements added so far.
  void rest();
  /// Time of all motion up to the last rest, s; each piece between two rests takes whole cycles.
  double seconds() const { return seconds_; }

 private:
  void put(const Moment& moment) override;
  void take_entries();
  void take(const Entry& entry);
  void look_along(const Piece& piece, const Profile& way);
  Moment moment(const Piece& piece, const MotionState& state, double jerk) const;
  void look_along_course();
  double whole_cycles(double seconds) const;

  Config config_;
  MomentSink* look_;
  Track track_;
  Planner planner_;
  std::deque<Moment> moments_;  ///< of courses, not yet shown
  std::uint64_t taken_ = 0;     ///< entries of the track
  bool on_course_ = false;      ///< the last entry is of a course that goes on
  bool course_begun_ = false;   ///< its first moment has been shown
  double seconds_ = 0.0;
};

}  // namespace servogate::path
