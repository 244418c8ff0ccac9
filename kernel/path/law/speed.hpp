// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "kernel/path/shape/element.hpp"

namespace servogate::path {

/// What a knot of the curve may not exceed.
struct KnotBound {
  double feed = 0.0;  ///< speed of the vector over mm and degrees, per s, > 0; infinite: none
  const std::array<AxisLimits, kMaxAxes>* limits = nullptr;  ///< of the axes, as Config has them
};

/// The fastest way along a given curve. The curve is a uniform cubic B-spline whose parameter runs by `step`
/// s an interval; the law is b = (d parameter / dt)^2, a uniform quadratic B-spline `beta` on the same knots:
/// interval k is made of beta k to k + 2, so that velocity and acceleration are continuous.
struct SpeedProblem {
  int axes = 0;                       ///< 1 - kMaxAxes
  std::array<int, kMaxAxes> axis{};   ///< of the machine, for each axis of the controls
  double step = 0.0;                  ///< > 0
  std::span<const double> controls;   ///< `axes` values each, three more than intervals
  std::span<const KnotBound> bounds;  ///< one a knot
  double share = 1.0;                 ///< of the limits that is planned for, 0 - 1
  std::vector<double> beta;           ///< start, inside of all limits, then solution; two more than intervals
  int fixed_head = 0, fixed_tail = 0;  ///< beta that are given
  double first = 0.3;                  ///< the same of the first weight of the barrier: less near the optimum
  double gap = 0.01;                   ///< how near to the optimum, about, as a share of the time
};

/// How much of each limit is used, 1: all of it.
struct Excess {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
  double most() const { return std::max({velocity, acceleration, jerk}); }
};

/// How many times as much limits count, place by place: acceleration at knots and middles (knot, middle, knot
/// ...), jerk in intervals, b at knots.
struct Tightness {
  std::vector<double> acceleration, jerk, cap;
};

/// Solves SpeedProblem by logarithmic barrier and Newton's method with bounded numbers of steps: each iterate
/// keeps the limits at the knots, and those of jerk in the middle of intervals too. Keeps its working memory
/// for prepare(), and nothing else. Not real-time safe.
class SpeedLaw {
 public:
  /// Takes up a problem: all of it but beta.
  void prepare(const SpeedProblem& problem);
  /// For each knot the largest constant beta around it, and by how much beta may change to the next with a
  /// share of the acceleration; then only the first `intervals` stay.
  void flat_levels(std::vector<double>& levels, std::vector<double>& slopes, int intervals);
  /// Largest share of a limit at the places looked at; below 1: inside.
  double worst(std::span<const double> beta) const;
  /// False: beta is not inside; it stays what it was.
  bool solve(SpeedProblem& problem);
  /// Makes limits count more, and brings beta inside of them and of all others: what it breaks is widened as
  /// far as it must be, and comes back step by step. What is given stays. False: not all came back.
  bool approach(SpeedProblem& problem, const Tightness& wanted);
  /// All limits as they are.
  Tightness as_they_are() const;
  /// Time that beta takes, s.
  double time(std::span<const double> beta) const;
  int steps() const { return steps_; }

 private:
  /// Two knots beside each other, whose arithmetic is done at once.
  using Pair = double __attribute__((vector_size(16)));
  /// Factors by which beta make the limits of an axis: at a knot (two beta), in the middle behind it, and for
  /// the jerk at start, middle and end of that interval (three each).
  enum : std::size_t { kKnot = 0, kMiddle = 2, kJerk = 5, kFactors = 14 };
  struct Rows {
    Pair f[kFactors];
  };
  /// Gradient and second derivatives by three beta that follow each other.
  struct Sums {
    Pair g0, g1, g2, h00, h01, h02, h11, h12, h22;
    void keep_knot(const Pair* f, Pair e, double mu);
    void keep(Pair d0, Pair d1, Pair d2, Pair e, double mu);
  };
  std::size_t whole_pairs() const { return 2 * (static_cast<std::size_t>(intervals_) / 2 + 1); }  // of knots
  double factor(int axis, std::size_t which, int k) const {
    return rows_[static_cast<std::size_t>(k / 2 * axes_ + axis)].f[which][k % 2];
  }
  void set_factor(int axis, std::size_t which, int k, double to) {
    rows_[static_cast<std::size_t>(k / 2 * axes_ + axis)].f[which][k % 2] = to;
  }
  /// What beta make of a limit.
  double use(int axis, std::size_t which, int k, const double* q) const {
    return factor(axis, which, k) * q[0] + factor(axis, which + 1, k) * q[1] +
           factor(axis, which + 2, k) * q[2];
  }
  double use_at_knot(int axis, int k, const double* q) const {
    return factor(axis, kKnot, k) * q[0] + factor(axis, kKnot + 1, k) * q[1];
  }
  void prepare_knot(const SpeedProblem& problem, int k);
  void prepare_interval(const SpeedProblem& problem, int k);
  double cost(const std::vector<double>& beta, double mu);
  void take_places(const std::vector<double>& beta);
  void clear_behind();
  void derive(double mu);
  void derive_time(double mu);
  void derive_limits(double mu);
  void gather();
  void fix(int i);
  double direction();
  double row_count() const { return (5.0 * axes_ + 2.0) * (intervals_ + 1); }
  bool centre(double mu, int most, double decrement);
  void uses(const std::vector<double>& beta, Tightness& out) const;
  void scale(const Tightness& factors);
  bool descend(double mu, double last);

  int axes_ = 0, intervals_ = 0, fixed_head_ = 0, fixed_tail_ = 0, steps_ = 0;
  double step_ = 0.0;
  std::vector<double> d1_, d2_;  // of the curve at knots
  std::vector<double> cap_;      // of b at knots
  std::vector<Rows> rows_;       // by pair of knots and axis; zero where there is none
  // Of one beta, whole pairs of knots and what they look at behind them: beta, b at knots and in the middles,
  // roots of b, their inverse by two, and the room that is left.
  std::vector<double> q_, knot_, middle_, knot_root_, middle_root_, knot_half_, middle_half_, room_;
  std::vector<Sums> sums_;
  std::vector<double> beta_, trial_, gradient_, h0_, h1_, h2_, move_;
};

}  // namespace servogate::path
