// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/knot.hpp"
#include "kernel/path/law/rate.hpp"
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// How far a course from rest to rest is known. What is known is final.
struct CourseExtent {
  std::uint64_t pieces = 0;  ///< of the programmed path, from its first one on
  std::uint64_t knots = 0;   ///< with the two before the first
  std::uint64_t stops = 0;   ///< that are known, the newest one last
  bool complete = false;     ///< it rests in the last knot
  /// There is no law for what comes next: it rests where the newest stop leads to, or at its start without
  /// one.
  bool broken = false;
  LawTime rest;          ///< law time of that place
  bool confirm = false;  ///< it goes on behind its end after Follower::release_stop()
  double seconds = 0.0;  ///< law time to the newest stop, or time to the rest
};

/// Where courses go, in order.
class CourseSink {
 public:
  virtual void begin_course() = 0;
  virtual void put(const Piece& piece) = 0;
  virtual void put(const Knot& knot) = 0;
  virtual void put(const StopHint& stop) = 0;
  /// Pieces, knots and stops of the course in work that were put may be driven.
  virtual void extend(const CourseExtent& extent) = 0;

 protected:
  ~CourseSink() = default;
};

}  // namespace servogate::path
