// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/speed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace servogate::path {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLargestCap = 1e8;
// b at the start, middle and end of an interval, by the beta it is made of.
constexpr double kAt[3][3] = {{0.5, 0.5, 0.0}, {0.125, 0.75, 0.125}, {0.0, 0.5, 0.5}};

// Barrier: first weight as a share of time by rows, factor, last weight, decrement to stop at.
constexpr double kFirst = 0.3, kFactor = 0.2, kGap = 0.01, kDecrement = 0.01;
constexpr int kSteps = 30;

double at(const double (&weights)[3], const double* beta) {
  return weights[0] * beta[0] + weights[1] * beta[1] + weights[2] * beta[2];
}

/// b at a knot; the last one has no third beta.
double at_knot(const double* beta) { return 0.5 * (beta[0] + beta[1]); }

}  // namespace

void SpeedLaw::prepare(const SpeedProblem& p) {
  axes_ = p.axes;
  step_ = p.step;
  intervals_ = static_cast<int>(p.controls.size()) / p.axes - 3;
  const auto n = static_cast<std::size_t>(intervals_), axes = static_cast<std::size_t>(axes_);
  cap_.resize(n + 1);
  d1_.resize((n + 1) * axes);
  d2_.resize((n + 1) * axes);
  acceleration_.resize((n + 1) * axes);
  jerk_.resize(n * 3 * axes);
  for (int k = 0; k <= intervals_; ++k) prepare_knot(p, k);
  for (int k = 0; k < intervals_; ++k) prepare_interval(p, k);
}

void SpeedLaw::prepare_knot(const SpeedProblem& p, int k) {
  const double i1 = 1.0 / step_, i2 = i1 * i1;
  const KnotBound& bound = p.bounds[static_cast<std::size_t>(k)];
  double linear = 0.0, turning = 0.0, cap = kLargestCap;
  for (int a = 0; a < axes_; ++a) {
    const int axis = p.axis[static_cast<std::size_t>(a)];
    const AxisLimits& limits = (*bound.limits)[static_cast<std::size_t>(axis)];
    const double* c = &p.controls[static_cast<std::size_t>(k * axes_ + a)];
    const double d1 = 0.5 * i1 * (c[2 * axes_] - c[0]);
    const double d2 = i2 * (c[2 * axes_] - 2.0 * c[axes_] + c[0]);
    (p.rotary[static_cast<std::size_t>(axis)] ? turning : linear) += d1 * d1;
    const double v = p.share * limits.velocity, s = 1.0 / (p.share * limits.acceleration);
    cap = std::min(cap, v * v / std::max(1e-30, d1 * d1));
    const auto at = static_cast<std::size_t>(k * axes_ + a);
    d1_[at] = d1;
    d2_[at] = d2;
    acceleration_[at] = {{s * 0.5 * (d2 - d1 * i1), s * 0.5 * (d2 + d1 * i1), 0.0}};
  }
  const double along = bound.turning ? turning : linear;
  if (std::isfinite(bound.feed)) cap = std::min(cap, bound.feed * bound.feed / std::max(1e-30, along));
  cap_[static_cast<std::size_t>(k)] = cap;
}

void SpeedLaw::prepare_interval(const SpeedProblem& p, int k) {
  const double i1 = 1.0 / step_, i2 = i1 * i1, i3 = i2 * i1;
  for (int a = 0; a < axes_; ++a) {
    const auto axis = static_cast<std::size_t>(p.axis[static_cast<std::size_t>(a)]);
    const double least = std::min((*p.bounds[static_cast<std::size_t>(k)].limits)[axis].jerk,
                                  (*p.bounds[static_cast<std::size_t>(k + 1)].limits)[axis].jerk);
    const double* c = &p.controls[static_cast<std::size_t>(k * axes_ + a)];
    const double d3 = i3 * (c[3 * axes_] - 3.0 * c[2 * axes_] + 3.0 * c[axes_] - c[0]);
    const double s = 1.0 / (p.share * least);
    const double d1 = d1_[static_cast<std::size_t>(k * axes_ + a)];
    const double d2 = d2_[static_cast<std::size_t>(k * axes_ + a)];
    for (int place = 0; place < 3; ++place) {
      // Jerk by sqrt(b): x''' b + 3/2 x'' b' + 1/2 x' b''.
      const double f = 0.5 * place, e2 = d2 + f * step_ * d3,
                   e1 = d1 + f * step_ * (d2 + 0.5 * f * step_ * d3);
      const double slope[3] = {-(1.0 - f) * i1, (1.0 - 2.0 * f) * i1, f * i1};
      const double bend[3] = {i2, -2.0 * i2, i2};
      Row& row = jerk_[static_cast<std::size_t>((k * 3 + place) * axes_ + a)];
      for (int q = 0; q < 3; ++q)
        row.f[q] = s * (d3 * kAt[place][q] + 1.5 * e2 * slope[q] + 0.5 * e1 * bend[q]);
    }
  }
}

double SpeedLaw::time(std::span<const double> q) const {
  double sum = 0.0, before = 1.0 / std::sqrt(0.5 * (q[0] + q[1]));
  for (std::size_t k = 0; k < static_cast<std::size_t>(intervals_); ++k) {
    const double middle = 1.0 / std::sqrt(at(kAt[1], &q[k])), end = 1.0 / std::sqrt(at(kAt[2], &q[k]));
    sum += before + 4.0 * middle + end;
    before = end;
  }
  return sum * step_ / 6.0;
}

double SpeedLaw::cost(const std::vector<double>& beta, double mu) const {
  double product = 1.0, logs = 0.0;
  for (const double b : beta)
    if (!(b > 0.0)) return kInfinite;
  for (int k = 0; k <= intervals_; ++k) {
    const double* q = &beta[static_cast<std::size_t>(k)];
    const double room = 1.0 - at_knot(q) / cap_[static_cast<std::size_t>(k)];
    if (!(room > 0.0)) return kInfinite;
    product *= room * q[0];
    const Row* rows = &acceleration_[static_cast<std::size_t>(k * axes_)];
    for (int a = 0; a < axes_; ++a) {
      const double e = rows[a].f[0] * q[0] + rows[a].f[1] * q[1], r = 1.0 - e * e;
      if (!(r > 0.0)) return kInfinite;
      product *= r;
    }
    if (k < intervals_) {
      const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
      for (const auto& weights : kAt) {
        const double b = at(weights, q);
        for (int a = 0; a < axes_; ++a, ++row) {
          const double e = at(row->f, q), r = 1.0 - e * e * b;
          if (!(r > 0.0)) return kInfinite;
          product *= r;
        }
      }
    }
    if (product < 1e-100 || product > 1e100) {
      logs += std::log(product);
      product = 1.0;
    }
  }
  return time_weight_ * time(beta) - mu * (logs + std::log(product * beta.back()));
}

double SpeedLaw::worst(std::span<const double> beta) const {
  double most = 0.0;
  for (int k = 0; k <= intervals_; ++k) {
    const double* q = &beta[static_cast<std::size_t>(k)];
    if (!(q[0] > 0.0)) return kInfinite;
    most = std::max(most, 0.5 * (q[0] + q[1]) / cap_[static_cast<std::size_t>(k)]);
    for (int a = 0; a < axes_; ++a) {
      const Row& row = acceleration_[static_cast<std::size_t>(k * axes_ + a)];
      most = std::max(most, std::abs(row.f[0] * q[0] + row.f[1] * q[1]));
    }
    if (k == intervals_) break;
    const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
    for (const auto& weights : kAt)
      for (int a = 0; a < axes_; ++a, ++row)
        most = std::max(most, std::abs(at(row->f, q)) * std::sqrt(at(weights, q)));
  }
  return beta.back() > 0.0 ? most : kInfinite;
}

void SpeedLaw::add(int k, const double* d, double first, double second) {
  const auto i = static_cast<std::size_t>(k);
  const double x = second * d[0], y = second * d[1], z = second * d[2];
  gradient_[i] += first * d[0];
  gradient_[i + 1] += first * d[1];
  gradient_[i + 2] += first * d[2];
  h0_[i] += x * d[0];
  h0_[i + 1] += y * d[1];
  h0_[i + 2] += z * d[2];
  h1_[i] += x * d[1];
  h1_[i + 1] += y * d[2];
  h2_[i] += x * d[2];
}

void SpeedLaw::derive_time(int k) {
  const double* q = &beta_[static_cast<std::size_t>(k)];
  const auto one = [&](int place, double b, double weight) {
    const double r = time_weight_ * weight / (b * std::sqrt(b));
    add(k, kAt[place], -0.5 * r, 0.75 * r / b);
  };
  one(0, at_knot(q), (k == 0 || k == intervals_ ? 1.0 : 2.0) * step_ / 6.0);
  if (k < intervals_) one(1, at(kAt[1], q), 4.0 * step_ / 6.0);
}

void SpeedLaw::derive_knot(int k, double mu) {
  const auto i = static_cast<std::size_t>(k);
  const double* q = &beta_[i];
  const double s = mu / (cap_[i] - at_knot(q));
  add(k, kAt[0], s, s * s / mu);
  gradient_[i] -= mu / q[0];
  h0_[i] += mu / (q[0] * q[0]);
  for (int a = 0; a < axes_; ++a) {
    const Row& row = acceleration_[static_cast<std::size_t>(k * axes_ + a)];
    const double e = row.f[0] * q[0] + row.f[1] * q[1], r = 1.0 / (1.0 - e * e);
    add(k, row.f, 2.0 * mu * e * r, mu * (2.0 * r + 4.0 * e * e * r * r));
  }
}

void SpeedLaw::derive_jerk(const Row& row, int k, double b, const double* weights, double mu) {
  const double root = std::sqrt(b), f = at(row.f, &beta_[static_cast<std::size_t>(k)]), e = f * root;
  const double r = 1.0 / (1.0 - e * e), by_root = 0.5 * f / root;
  const double d[3] = {root * row.f[0] + by_root * weights[0], root * row.f[1] + by_root * weights[1],
                       root * row.f[2] + by_root * weights[2]};
  add(k, d, 2.0 * mu * e * r, mu * (2.0 * r + 4.0 * e * e * r * r));
}

void SpeedLaw::derive_interval(int k, double mu) {
  const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
  for (const auto& weights : kAt) {
    const double b = at(weights, &beta_[static_cast<std::size_t>(k)]);
    for (int a = 0; a < axes_; ++a, ++row) derive_jerk(*row, k, b, weights, mu);
  }
}

void SpeedLaw::fix(int i) {
  const auto k = static_cast<std::size_t>(i);
  gradient_[k] = 0.0;
  h0_[k] = 1.0;
  h1_[k] = h2_[k] = 0.0;
  if (i >= 1) h1_[k - 1] = 0.0;
  if (i >= 2) h2_[k - 2] = 0.0;
}

void SpeedLaw::derive(double mu) {
  const auto size = static_cast<std::size_t>(intervals_) + 4;
  for (auto* v : {&gradient_, &h0_, &h1_, &h2_}) v->assign(size, 0.0);
  for (int k = 0; k <= intervals_; ++k) {
    derive_time(k);
    derive_knot(k, mu);
    if (k < intervals_) derive_interval(k, mu);
  }
  const auto end = static_cast<std::size_t>(intervals_) + 1;
  gradient_[end] -= mu / beta_[end];
  h0_[end] += mu / (beta_[end] * beta_[end]);
  for (int i = 0; i < fixed_head_; ++i) fix(i);
  for (int i = 0; i < fixed_tail_; ++i) fix(intervals_ + 1 - i);
}

/// Newton's step by L D L' of the pentadiagonal matrix; its decrement.
double SpeedLaw::direction() {
  const auto n = static_cast<std::size_t>(intervals_) + 2;
  move_.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double d = h0_[i], l = h1_[i], y = -gradient_[i];
    if (i >= 1) {
      const double q = h1_[i - 1] * h0_[i - 1];
      d -= h1_[i - 1] * q;
      l -= h2_[i - 1] * q;
      y -= h1_[i - 1] * move_[i - 1];
    }
    if (i >= 2) {
      d -= h2_[i - 2] * h2_[i - 2] * h0_[i - 2];
      y -= h2_[i - 2] * move_[i - 2];
    }
    d = std::max(d, 1e-12 * h0_[i]);
    h0_[i] = d;
    h1_[i] = l / d;
    h2_[i] /= d;
    move_[i] = y;
  }
  double decrement = 0.0;
  for (std::size_t i = n; i-- > 0;) {
    double y = move_[i] / h0_[i];
    if (i + 1 < n) y -= h1_[i] * move_[i + 1];
    if (i + 2 < n) y -= h2_[i] * move_[i + 2];
    move_[i] = y;
    decrement -= gradient_[i] * y;
  }
  return decrement;
}

bool SpeedLaw::centre(double mu, int most, double decrement) {
  double now = cost(beta_, mu);
  for (int q = 0; q < most; ++q) {
    derive(mu);
    ++steps_;
    const double d = direction();
    if (!std::isfinite(d) || d < 0.0) return false;
    if (d < decrement) return true;
    double t = 1.0, there = kInfinite;
    for (std::size_t i = 0; i < beta_.size(); ++i)
      if (move_[i] < 0.0) t = std::min(t, -0.95 * beta_[i] / move_[i]);
    for (; t > 1e-9; t *= 0.5) {
      trial_.resize(beta_.size());
      for (std::size_t i = 0; i < beta_.size(); ++i) trial_[i] = beta_[i] + t * move_[i];
      if ((there = cost(trial_, mu)) < now - 1e-4 * t * d) break;
    }
    if (!(there < now)) return true;
    beta_.swap(trial_);
    now = there;
  }
  return true;
}

bool SpeedLaw::descend(double mu, double last) {
  const double rows = (3.0 * axes_ + axes_ + 2.0) * (intervals_ + 1) + 1.0;
  for (int round = 0; round < 40; ++round, mu *= kFactor) {
    if (!centre(mu, kSteps, kDecrement * mu * static_cast<double>(beta_.size()))) return false;
    if (mu * rows < last * time(beta_)) return true;
  }
  return true;
}

bool SpeedLaw::solve(SpeedProblem& p) {
  fixed_head_ = p.fixed_head;
  fixed_tail_ = p.fixed_tail;
  steps_ = 0;
  if (!(worst(p.beta) < 1.0)) return false;
  beta_ = p.beta;
  const double rows = (4.0 * axes_ + 2.0) * (intervals_ + 1);
  descend(kFirst * time(beta_) / rows, kGap);
  p.beta = beta_;
  return true;
}

void SpeedLaw::flat_levels(std::vector<double>& levels, int intervals) {
  levels.assign(cap_.begin(), cap_.end());
  const double ones[3] = {1.0, 1.0, 1.0};
  for (int k = 0; k <= intervals_; ++k) {
    double& level = levels[static_cast<std::size_t>(k)];
    for (int a = 0; a < axes_; ++a) {
      const Row& row = acceleration_[static_cast<std::size_t>(k * axes_ + a)];
      level = std::min(level, 1.0 / std::max(1e-12, std::abs(row.f[0] + row.f[1])));
    }
    if (k == intervals_) break;
    double jerk = 1e-12;
    const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
    for (int q = 0; q < 3 * axes_; ++q, ++row) jerk = std::max(jerk, std::abs(at(row->f, ones)));
    const double by_jerk = 1.0 / std::cbrt(jerk * jerk);
    level = std::min(level, by_jerk);
    levels[static_cast<std::size_t>(k) + 1] = std::min(levels[static_cast<std::size_t>(k) + 1], by_jerk);
  }
  intervals_ = intervals;
}

void SpeedLaw::scale_limits(double factor) {
  for (double& cap : cap_) cap *= factor;
  for (auto* rows : {&acceleration_, &jerk_})
    for (Row& row : *rows)
      for (double& f : row.f) f /= factor;
}

bool SpeedLaw::find_start(SpeedProblem& p) {
  constexpr int kRounds = 40, kStartSteps = 20;
  constexpr double kOutside = 1.02, kInside = 0.98, kStartDecrement = 0.01;
  fixed_head_ = p.fixed_head;
  fixed_tail_ = 0;
  beta_ = p.beta;
  time_weight_ = 0.0;
  double worst_now = worst(beta_), scaled = 1.0;
  for (int round = 0; round < kRounds && worst_now >= kInside && std::isfinite(worst_now); ++round) {
    // The limits are wider than they should be by `scaled`, and the centre of what they allow lies deeper in.
    scale_limits(kOutside * worst_now / scaled);
    scaled = kOutside * worst_now;
    if (!centre(1.0, kStartSteps, kStartDecrement)) break;
    worst_now = worst(beta_) * scaled;
  }
  scale_limits(1.0 / scaled);
  time_weight_ = 1.0;
  if (!(worst(beta_) < 1.0)) return false;
  p.beta = beta_;
  return true;
}

bool SpeedLaw::solve_again(SpeedProblem& p) {
  if (!(worst(p.beta) < 1.0)) return false;
  beta_ = p.beta;
  const double rows = (4.0 * axes_ + 2.0) * (intervals_ + 1);
  descend(10.0 * kGap * time(beta_) / rows, 0.5 * kGap);
  p.beta = beta_;
  return true;
}

void SpeedLaw::tighten(int interval, double factor) {
  for (Row *row = &jerk_[static_cast<std::size_t>(interval * 3 * axes_)], *end = row + 3 * axes_; row != end;
       ++row)
    for (double& f : row->f) f *= factor;
  const double half = 1.0 + 0.5 * (factor - 1.0);
  for (Row *row = &acceleration_[static_cast<std::size_t>(interval * axes_)], *end = row + 2 * axes_;
       row != end; ++row)
    for (double& f : row->f) f *= half;
}

}  // namespace servogate::path
