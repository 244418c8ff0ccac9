// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>

#include "kernel/path/law/motion.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {

/// How long a path takes at override 1. The spans are the planner's, the time of each is the law's (Timing);
/// of a course its speeds are foretold (SpeedForecast), and so is its time: about. No cycle is stepped, so
/// the cost goes with the path and not with the time it takes. Waiting for the axes to be in position is not
/// counted. Not real-time safe.
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
  void take_pieces();
  void time_spans();
  void look_along(const Span& span);
  Moment moment(const Piece& piece, const MotionState& state, double jerk) const;
  void look_along_course();
  std::uint64_t command_of(const Span& span) const;
  double whole_cycles(double seconds) const;

  Config config_;
  MomentSink* look_;
  Track track_;
  Planner planner_;
  std::deque<Span> spans_;  ///< published, not yet timed
  std::deque<Piece> pieces_;
  std::uint64_t first_piece_ = 0;  ///< number of the first of them
  std::deque<Moment> moments_;     ///< of courses, not yet shown
  std::uint64_t taken_ = 0;        ///< entries of the track
  bool on_course_ = false;         ///< the last entry is of a course that goes on
  bool course_begun_ = false;      ///< its first moment has been shown
  Timing timing_;
  double way_ = 0.0;  ///< time since the last rest, s
  double seconds_ = 0.0;
};

}  // namespace servogate::path
