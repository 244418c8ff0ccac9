// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

#include "kernel/path/shape/run.hpp"

namespace servogate::path {

/// A first clock for a run: how fast the programmed path, rounded within its tolerance, may be driven,
/// roughly. Gives places on the path that are even in that time. It need not be right, only sane: shape and
/// law are made on it, and the law's time is a better one. Works in windows whose bounds go with the length
/// of the path and not with what has arrived. Not real-time safe.
class ClockEstimate {
 public:
  /// `step`: s between places.
  ClockEstimate(int axes, const Transformation& transformation, double step)
      : axes_(axes), transformation_(&transformation), step_(step) {}
  void clear(double step);
  /// Appends places of one window, if all that it looks at is known; `ended`: the run rests behind its last
  /// leg. The first place is 0; the last one, when it is done, the run's length. False: nothing was to be
  /// done.
  bool work(const Run& run, bool ended, Kept<double>& places);
  bool done() const { return done_; }
  /// Legs before this are no longer looked at.
  double needs_from() const { return begin_; }

 private:
  struct Node {
    double u, y;
  };
  struct Raw {
    double u, step;
  };
  bool window(const Run& run, bool ended);
  void look_at_limits(const Run& run, std::size_t first, double end);
  double reach(double v) const;
  double full_window() const;
  void solve(const Run& run, double end, bool last);
  void sample(const Run& run, double end);
  void cap_by_limits();
  void cap_by_scale(int h);
  void carry_caps();
  void free_straights(const Run& run);
  void nodes(const Run& run, double end, bool last);
  void sharp_corners(const Run& run, double end);
  void nodes_around(double u, double y, double end);
  void reach_between();
  double reached(const Node& from, const Node& to) const;
  void raw_steps(double end, bool last);
  void smooth(bool last);
  bool commit(bool last, std::size_t fewest);
  void integrate(const Run& run, Kept<double>& places);
  void stretch(double length, Kept<double>& places);
  std::size_t sample_at(double u) const;

  int axes_;
  const Transformation* transformation_;
  double step_;
  bool done_ = false, decided_ = false;
  double begin_ = 0.0, begin_y_ = 0.0, trial_ = 0.0;
  // One window.
  double origin_ = 0.0, spacing_ = 0.0, feed_ = 0.0, free_to_ = 0.0, reached_ = 0.0;
  AxisLimits slowest_;
  std::vector<Vector> at_;  // of the axes
  std::vector<const Leg*> legs_;
  std::vector<double> feeds_;
  std::vector<double> limit_cap_, cap_, jerk_root_, acceleration_, time_, old_cap_, steps_, smooth_;
  double old_origin_ = 0.0, old_spacing_ = 0.0;
  std::vector<Node> nodes_;
  std::vector<double> raw_;
  // From window to window.
  std::vector<double> past_;    // raw steps before begin_
  std::size_t past_count_ = 0;  // all of them since the start of the run
  Kept<Raw> field_;             // length of a step, over the path
  std::size_t field_at_ = 0;
  double place_ = 0.0;
  std::vector<double> fresh_;
};

}  // namespace servogate::path
