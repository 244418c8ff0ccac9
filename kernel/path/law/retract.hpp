// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/s_curve.hpp"

namespace servogate::path {

/// The way of the axes off a thread that is left: each by its share of Threads::retract, beside what the path
/// still moves, inside of what its limits have left. All functions are real-time safe.
class Retract {
 public:
  /// The path beside it, until it rests.
  struct Path {
    Vector along{};    ///< the most that each axis moves for a path of 1
    Box box;           ///< speed, acceleration and jerk are at most these
    Vector at{};       ///< where the axes are
    double way = 0.0;  ///< mm of path to its rest
  };
  /// From rest. `lock` says which axes stay, and which go against the sign of Threads::retract; none leaves
  /// its travel. An axis to which too little is left of its limits waits for path_rests().
  void begin(const Config& config, const Lock& lock, const Path& path) noexcept;
  /// All of the limits are there now.
  void path_rests(const Config& config) noexcept;
  void step(double seconds) noexcept;
  void clear() noexcept { count_ = 0; }
  /// Some way is to be gone, or under way.
  bool moving() const noexcept;
  /// Of one axis, besides the path.
  MotionState at(int axis) const noexcept;

 private:
  struct Way {
    int axis = 0;
    double sign = 1.0;
    bool begun = false;
    Profile profile;
    double clock = 0.0;
  };
  static double distance(const Config& config, const Lock& lock, const Path& path, int axis) noexcept;
  static void plan_way(Way& way, double distance, const AxisLimits& limits) noexcept;
  std::array<Way, kMaxAxes> ways_{};
  std::array<double, kMaxAxes> distance_{};
  int count_ = 0;
};

}  // namespace servogate::path
