// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/speed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/law/speed_places.hpp"

namespace servogate::path {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Barrier: factor from weight to weight, decrement to stop at.
constexpr double kFactor = 0.2, kDecrement = 0.1;
constexpr int kSteps = 30;

}  // namespace

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
    const Row* rows = &acceleration_[static_cast<std::size_t>(2 * k * axes_)];
    for (int a = 0; a < axes_; ++a) {
      const double e = rows[a].f[0] * q[0] + rows[a].f[1] * q[1], r = 1.0 - e * e;
      if (!(r > 0.0)) return kInfinite;
      product *= r;
    }
    for (int a = axes_; a < 2 * axes_ && k < intervals_; ++a) {
      const double e = at(rows[a].f, q), r = 1.0 - e * e;
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
  return time(beta) - mu * (logs + std::log(product * beta.back()));
}

double SpeedLaw::worst(std::span<const double> beta) const {
  double most = 0.0;
  for (int k = 0; k <= intervals_; ++k) {
    const double* q = &beta[static_cast<std::size_t>(k)];
    if (!(q[0] > 0.0)) return kInfinite;
    most = std::max(most, 0.5 * (q[0] + q[1]) / cap_[static_cast<std::size_t>(k)]);
    for (int a = 0; a < axes_; ++a) {
      const Row& row = acceleration_[static_cast<std::size_t>(2 * k * axes_ + a)];
      most = std::max(most, std::abs(row.f[0] * q[0] + row.f[1] * q[1]));
    }
    if (k == intervals_) break;
    for (int a = axes_; a < 2 * axes_; ++a)
      most = std::max(most, std::abs(at(acceleration_[static_cast<std::size_t>(2 * k * axes_ + a)].f, q)));
    const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
    for (const auto& weights : kAt)
      for (int a = 0; a < axes_; ++a, ++row)
        most = std::max(most, std::abs(at(row->f, q)) * std::sqrt(at(weights, q)));
  }
  return beta.back() > 0.0 ? most : kInfinite;
}

/// Gradient and second derivatives by three beta that follow each other.
struct SpeedLaw::Sum {
  double g[3] = {}, h[6] = {};  // 00 01 02 11 12 22

  void add(const double* d, double first, double second) {
    const double x = second * d[0], y = second * d[1];
    for (int i = 0; i < 3; ++i) {
      g[i] += first * d[i];
      h[i] += x * d[i];
    }
    h[3] += y * d[1];
    h[4] += y * d[2];
    h[5] += second * d[2] * d[2];
  }
  /// The barrier of 1 - e^2 > 0, where e changes by d.
  void keep(const double* d, double e, double mu) {
    const double r = 1.0 / (1.0 - e * e), first = 2.0 * mu * e * r;
    add(d, first, 2.0 * r * (mu + e * first));
  }
};

void SpeedLaw::derive_at(int k, double mu) {
  const auto i = static_cast<std::size_t>(k);
  const double* q = &beta_[i];
  Sum sum;
  const auto time = [&](int place, double b, double weight) {
    const double r = weight / (b * std::sqrt(b));
    sum.add(kAt[place], -0.5 * r, 0.75 * r / b);
  };
  time(0, at_knot(q), (k == 0 || k == intervals_ ? 1.0 : 2.0) * step_ / 6.0);
  const double s = mu / (cap_[i] - at_knot(q));
  sum.add(kAt[0], s, s * s / mu);
  const Row* rows = &acceleration_[static_cast<std::size_t>(2 * k * axes_)];
  for (int a = 0; a < axes_; ++a) sum.keep(rows[a].f, rows[a].f[0] * q[0] + rows[a].f[1] * q[1], mu);
  if (k < intervals_) {
    time(1, at(kAt[1], q), 4.0 * step_ / 6.0);
    for (int a = axes_; a < 2 * axes_; ++a) sum.keep(rows[a].f, at(rows[a].f, q), mu);
    const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
    for (const auto& weights : kAt) {
      const double root = std::sqrt(at(weights, q)), half = 0.5 / root;
      for (int a = 0; a < axes_; ++a, ++row) {
        const double f = at(row->f, q), by_root = half * f;
        const double d[3] = {root * row->f[0] + by_root * weights[0], root * row->f[1] + by_root * weights[1],
                             root * row->f[2] + by_root * weights[2]};
        sum.keep(d, f * root, mu);
      }
    }
  }
  gradient_[i] += sum.g[0] - mu / q[0];
  gradient_[i + 1] += sum.g[1];
  gradient_[i + 2] += sum.g[2];
  h0_[i] += sum.h[0] + mu / (q[0] * q[0]);
  h1_[i] += sum.h[1];
  h2_[i] += sum.h[2];
  h0_[i + 1] += sum.h[3];
  h1_[i + 1] += sum.h[4];
  h0_[i + 2] += sum.h[5];
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
    derive_at(k, mu);
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
  const double rows = row_count();
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
  const double rows = row_count();
  descend(p.first * time(beta_) / rows, p.gap);
  p.beta = beta_;
  return true;
}

bool SpeedLaw::approach(SpeedProblem& p, const Tightness& wanted) {
  constexpr int kRounds = 60, kRoundSteps = 6;
  constexpr double kInside = 0.9995, kNear = 0.9998, kCentred = 3.0;
  fixed_head_ = p.fixed_head;
  fixed_tail_ = p.fixed_tail;
  beta_ = p.beta;
  Tightness given = as_they_are(), use, step;
  const auto each = [&](auto&& f) {
    for (std::size_t k = 0; k < use.acceleration.size(); ++k)
      f(step.acceleration[k], given.acceleration[k], use.acceleration[k], wanted.acceleration[k]);
    for (std::size_t k = 0; k < use.jerk.size(); ++k)
      f(step.jerk[k], given.jerk[k], use.jerk[k], wanted.jerk[k]);
    for (std::size_t k = 0; k < use.cap.size(); ++k) f(step.cap[k], given.cap[k], use.cap[k], wanted.cap[k]);
  };
  uses(beta_, use);
  step = as_they_are();
  each([&](double& by, double& now, double used, double) {
    now = by = used > kInside ? kInside / used : 1.0;
  });
  scale(step);
  double missing = HUGE_VAL;
  for (int round = 0; round < kRounds; ++round) {
    const double mu = kCentred * time(beta_) / row_count();
    centre(mu, kRoundSteps, kDecrement * mu);
    uses(beta_, use);
    missing = 1.0;
    each([&](double& by, double& now, double used, double goal) {
      by = std::max(1.0, std::min(goal / now, kNear / std::max(used, 1e-9)));
      now *= by;
      missing = std::max(missing, goal / now);
    });
    scale(step);
    if (missing <= 1.0 + 1e-9) break;
  }
  p.beta = beta_;
  return missing <= 1.0 + 1e-9;
}

}  // namespace servogate::path
