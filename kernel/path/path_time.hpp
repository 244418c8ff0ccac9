// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>

#include "kernel/path/law/motion.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {

/// How long a path takes at override 1: the spans are the planner's, the time of each is the law's
/// (Timing). No cycle is stepped, so the cost goes with the elements and not with the
/// time they take. Waiting for the axes to be in position is not counted. Not real-time safe.
class PathTime {
 public:
  PathTime(const Config& config, const Vector& start);

  /// Appends an element. False: it cannot be driven, last_flaw() says why, and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return planner_.last_flaw(); }
  /// The path comes to rest behind the elements added so far.
  void rest();
  /// Time of all motion up to the last rest, s; each piece between two rests takes whole cycles.
  double seconds() const { return seconds_; }

 private:
  void take_entries();
  void time_spans();
  double whole_cycles(double seconds) const;

  Config config_;
  Track track_;
  Planner planner_;
  std::deque<Span> spans_;   ///< published, not yet timed
  std::uint64_t taken_ = 0;  ///< entries of the track
  Timing timing_;
  double way_ = 0.0;  ///< time since the last rest, s
  double seconds_ = 0.0;
};

}  // namespace servogate::path
