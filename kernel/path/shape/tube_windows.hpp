// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/kept.hpp"
#include "kernel/path/shape/run.hpp"
#include "kernel/path/shape/tube.hpp"

namespace servogate::path {

/// The curve of a run, made window by window: each sees a bounded number of knots, overlaps the one before
/// and goes on from its committed controls. The bounds of windows are numbers of knots since the start of the
/// run. Not real-time safe.
class TubeWindows {
 public:
  struct Settings {
    int axes = 0;
    double step = 0.0;     ///< s of a knot interval of the clock
    double share = 0.995;  ///< of the tolerance
    bool first = true;  ///< the clock is an estimate: peaks of jerk mean little, start on the programmed path
  };
  struct Counts {
    int windows = 0;
    int released = 0;  ///< places where the pairing does not keep the tolerance
    int outside = 0;   ///< and no other one does near there
    std::int64_t steps = 0, knot_steps = 0;
  };

  explicit TubeWindows(const Settings& settings) : settings_(settings) {}
  void clear(double step);

  /// `places`: path parameters at knots, `complete`: the last one is the end of the run. `start`: controls to
  /// begin with (not for the first pass). Appends controls that are final, those of one window a call and
  /// three more than knots intervals at the end. All of `run` from the first place on that is not committed
  /// must be kept. False: nothing was to be done.
  bool work(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
            Kept<Vector>& controls);
  bool done() const { return done_; }
  /// Knots before this are no longer looked at.
  std::size_t needs_from() const { return from_; }
  const Counts& counts() const { return counts_; }

 private:
  bool window(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
              Kept<Vector>& controls);
  void guess(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
             const Kept<Vector>& controls, std::size_t to);
  Vector at_end(const Run& run, bool begin, double n) const;
  void sites(const Run& run, const Kept<double>& places, std::size_t first, std::size_t end);
  bool inside_arc(const Run& run, std::size_t leg, double from, double to, std::size_t k, double u0,
                  double u1);
  void site(const Run& run, std::size_t leg, double u, std::size_t interval, double share);
  TubeSolution solve(const Run& run, const Kept<double>& places, std::size_t intervals, bool last);
  TubeSolution solve_on_path(const Run& run, const Kept<double>& places, std::size_t intervals, bool last,
                             const TubeSolution& before);
  void count_outside(const Run& run, const Kept<double>& places);
  void slide(const Leg& leg, double u, Site& site) const;
  void pack(std::size_t intervals, std::size_t head, std::size_t tail);
  void narrow(const Run& run, const Kept<double>& places);
  double bulge(const Run& run, const Kept<double>& places, std::size_t site, std::size_t leg,
               bool across) const;
  void limits_of_jerk(const Run& run, const Kept<double>& places, std::size_t intervals);

  Settings settings_;
  Tube tube_;
  TubeProblem problem_;
  Counts counts_;
  bool done_ = false;
  std::size_t from_ = 0;
  int made_ = 0;
  std::vector<Vector> guess_, blend_;  // controls from from_ on
  std::vector<Site> sites_;
  std::vector<std::size_t> site_legs_;
  std::vector<double> site_places_;
  std::array<int, kMaxAxes> axis_{};
  std::size_t leg_ = 0;
};

}  // namespace servogate::path
