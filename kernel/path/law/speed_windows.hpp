// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "kernel/path/law/speed.hpp"
#include "kernel/path/shape/kept.hpp"
#include "kernel/path/shape/run.hpp"

namespace servogate::path {

/// The law of a run, made window by window: each overlaps the one before by the way to stop, goes on from its
/// committed end with speed and acceleration, and begins slow enough to be inside of all limits. The bounds
/// of windows are numbers of knots since the start of the run. Not real-time safe.
class SpeedWindows {
 public:
  struct Settings {
    int axes = 0;
    double step = 0.0;      ///< s of a knot interval of the clock
    double reserve = 0.01;  ///< share of the limits that is not planned for
    const Transformation* transformation = &identity();
    bool judged = false;  ///< the course as published is looked at, and mended where it exceeds a limit
  };
  struct Counts {
    int windows = 0, repaired = 0;
    int slowed = 0;  ///< windows whose start had to be found
    int failed = 0;  ///< windows without a law inside of the limits: the run must not be driven
    std::int64_t steps = 0, knot_steps = 0;
  };

  explicit SpeedWindows(const Settings& settings) : settings_(settings) {}
  void clear(double step);

  /// `controls` of the curve and `places` at its knots, as far as they are final; `complete`: the run ends
  /// with them. Appends beta that is final, of one window a call. False: nothing was to be done.
  bool work(const Run& run, const Kept<double>& places, const Kept<Vector>& controls, bool complete,
            Kept<double>& beta);
  bool done() const { return done_; }
  double step() const { return settings_.step; }
  /// Intervals that were final before the last window.
  std::size_t open() const { return open_; }
  /// Knots before this are no longer looked at.
  std::size_t needs_from() const { return from_; }
  const Counts& counts() const { return counts_; }

 private:
  bool window(const Run& run, const Kept<double>& places, const Kept<Vector>& controls, bool complete,
              Kept<double>& beta);
  std::size_t overlap(const Run& run, const Kept<double>& places, std::size_t to) const;
  void bounds(const Run& run, const Kept<double>& places, std::size_t to, std::size_t last);
  const std::array<AxisLimits, kMaxAxes>* merged(const Run& run, std::size_t first, std::size_t end);
  void pack(const Kept<Vector>& controls, std::size_t to);
  void guess(std::size_t count, std::size_t intervals);
  void fly(bool end, double slow);
  bool near_clock();
  void solve(bool last, std::size_t commit);
  void mend(std::size_t commit);
  void tighten(double share);

  Settings settings_;
  SpeedLaw law_;
  SpeedProblem problem_;
  Counts counts_;
  bool done_ = false;
  std::size_t from_ = 0, open_ = 0;
  int made_ = 0, reckoned_ = -1;  // windows; the one that over_ belongs to
  std::size_t over_ = 0;          // knots of overlap
  std::size_t leg_ = 0;
  bool flies_in_ = false, flies_out_ = false;  // this window begins or ends at the clock's speed
  std::vector<double> rest_;  // beta from from_ on: committed head, and what the window before had behind it
  std::vector<Vector> on_axes_;
  std::vector<double> controls_, levels_, slopes_, calm_, trial_;
  std::vector<Excess> excess_;
  std::vector<KnotBound> bounds_;
  std::deque<std::array<AxisLimits, kMaxAxes>> merged_;
};

}  // namespace servogate::path
