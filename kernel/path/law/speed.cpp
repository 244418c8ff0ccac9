// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/speed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernel/path/law/speed_places.hpp"

namespace servogate::path {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Barrier: factor from weight to weight, decrement whose step is the last one: what is behind it is small.
constexpr double kFactor = 0.2, kDecrement = 3.0, kLastDecrement = 0.1;
constexpr int kSteps = 30;

template <class Pair>
Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

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

/// b at knots and middles. Behind the last knot all is 1, where no limit is.
void SpeedLaw::take_places(const std::vector<double>& beta) {
  const std::size_t knots = whole_pairs();
  std::copy(beta.begin(), beta.end(), q_.begin());
  for (std::size_t k = beta.size(); k < knots + 2; ++k) q_[k] = 1.0;
  for (std::size_t k = 0; k <= knots; ++k) knot_[k] = at_knot(&q_[k]);
  for (std::size_t k = 0; k < knots; ++k) middle_[k] = at(kAt[1], &q_[k]);
}

double SpeedLaw::cost(const std::vector<double>& beta, double mu) {
  for (const double b : beta)
    if (!(b > 0.0)) return kInfinite;
  take_places(beta);
  const auto n = static_cast<std::size_t>(intervals_), axes = static_cast<std::size_t>(axes_);
  for (std::size_t k = 0; k <= n; ++k) {
    const double room = 1.0 - knot_[k] / cap_[k];
    if (!(room > 0.0)) return kInfinite;
    room_[k] = room * beta[k];
  }
  room_[n + 1] = 1.0;
  double product = 1.0, logs = 0.0;
  for (std::size_t k = 0; k <= n; k += 2) {
    const Pair q0 = load<Pair>(&q_[k]), q1 = load<Pair>(&q_[k + 1]), q2 = load<Pair>(&q_[k + 2]);
    const Pair b0 = load<Pair>(&knot_[k]), b1 = load<Pair>(&middle_[k]), b2 = load<Pair>(&knot_[k + 1]);
    Pair room = load<Pair>(&room_[k]);
    auto inside = room > 0.0;
    const Rows* rows = &rows_[k / 2 * axes];
    for (std::size_t a = 0; a < axes; ++a) {
      const Pair* f = rows[a].f;
      const auto use = [&](std::size_t which) {
        return f[which] * q0 + f[which + 1] * q1 + f[which + 2] * q2;
      };
      const Pair e0 = f[0] * q0 + f[1] * q1, e1 = use(kMiddle);
      const Pair e2 = use(kJerk), e3 = use(kJerk + 3), e4 = use(kJerk + 6);
      const Pair r0 = 1.0 - e0 * e0, r1 = 1.0 - e1 * e1;
      const Pair r2 = 1.0 - e2 * e2 * b0, r3 = 1.0 - e3 * e3 * b1, r4 = 1.0 - e4 * e4 * b2;
      inside &= (r0 > 0.0) & (r1 > 0.0) & (r2 > 0.0) & (r3 > 0.0) & (r4 > 0.0);
      room *= r0 * r1 * (r2 * r3 * r4);
    }
    if (inside[0] == 0 || inside[1] == 0) return kInfinite;
    product *= room[0] * room[1];
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
    most = std::max(most, at_knot(q) / cap_[static_cast<std::size_t>(k)]);
    for (int a = 0; a < axes_; ++a) most = std::max(most, std::abs(use_at_knot(a, k, q)));
    if (k == intervals_) break;
    for (int a = 0; a < axes_; ++a) most = std::max(most, std::abs(use(a, kMiddle, k, q)));
    for (std::size_t place = 0; place < 3; ++place) {
      const double root = std::sqrt(at(kAt[place], q));
      for (int a = 0; a < axes_; ++a) most = std::max(most, std::abs(use(a, kJerk + 3 * place, k, q)) * root);
    }
  }
  return beta.back() > 0.0 ? most : kInfinite;
}

/// The barrier of 1 - e^2 > 0, where e changes by d.
inline void SpeedLaw::Sums::keep(Pair d0, Pair d1, Pair d2, Pair e, double mu) {
  const Pair r = 1.0 / (1.0 - e * e), first = 2.0 * mu * e * r, second = 2.0 * r * (mu + e * first);
  const Pair x = second * d0, y = second * d1;
  g0 += first * d0;
  g1 += first * d1;
  g2 += first * d2;
  h00 += x * d0;
  h01 += x * d1;
  h02 += x * d2;
  h11 += y * d1;
  h12 += y * d2;
  h22 += second * d2 * d2;
}

inline void SpeedLaw::Sums::keep_knot(const Pair* f, Pair e, double mu) {
  const Pair r = 1.0 / (1.0 - e * e), first = 2.0 * mu * e * r, second = 2.0 * r * (mu + e * first);
  const Pair x = second * f[0];
  g0 += first * f[0];
  g1 += first * f[1];
  h00 += x * f[0];
  h01 += x * f[1];
  h11 += second * f[1] * f[1];
}

/// The time, the largest b at a knot, and beta > 0.
void SpeedLaw::derive_time(double mu) {
  for (std::size_t k = 0; k <= whole_pairs(); ++k) {
    knot_root_[k] = std::sqrt(knot_[k]);
    middle_root_[k] = std::sqrt(middle_[k]);
    knot_half_[k] = 0.5 / knot_root_[k];
    middle_half_[k] = 0.5 / middle_root_[k];
  }
  constexpr const double(&w)[3] = kAt[1];
  const int last = intervals_;
  std::fill(sums_.begin(), sums_.end(), Sums{});
  for (int n = 0; n <= last; ++n) {
    const auto k = static_cast<std::size_t>(n), lane = k % 2;
    Sums& to = sums_[k / 2];
    // 1 / b is four times the square of what is kept, and so on.
    const double h = knot_half_[k], weight = (n == 0 || n == last ? 1.0 : 2.0) * step_ / 6.0;
    const double s = mu / (cap_[k] - knot_[k]), own = mu / q_[k];
    const double first = 0.5 * (s - 4.0 * weight * h * h * h);
    const double second = 0.25 * (s * s / mu + 24.0 * weight * h * h * h * h * h);
    const double m = n < last ? middle_half_[k] : 0.0, cube = 4.0 * step_ / 6.0 * m * m * m;
    const double first_m = -4.0 * cube, second_m = 24.0 * cube * m * m;
    to.g0[lane] = first - own + first_m * w[0];
    to.g1[lane] = first + first_m * w[1];
    to.g2[lane] = first_m * w[2];
    to.h00[lane] = second + own * own / mu + second_m * w[0] * w[0];
    to.h01[lane] = second + second_m * w[0] * w[1];
    to.h02[lane] = second_m * w[0] * w[2];
    to.h11[lane] = second + second_m * w[1] * w[1];
    to.h12[lane] = second_m * w[1] * w[2];
    to.h22[lane] = second_m * w[2] * w[2];
  }
}

void SpeedLaw::derive_limits(double mu) {
  const auto axes = static_cast<std::size_t>(axes_);
  for (std::size_t k = 0; k <= static_cast<std::size_t>(intervals_); k += 2) {
    const Pair q0 = load<Pair>(&q_[k]), q1 = load<Pair>(&q_[k + 1]), q2 = load<Pair>(&q_[k + 2]);
    const Pair roots[3] = {load<Pair>(&knot_root_[k]), load<Pair>(&middle_root_[k]),
                           load<Pair>(&knot_root_[k + 1])};
    const Pair halves[3] = {load<Pair>(&knot_half_[k]), load<Pair>(&middle_half_[k]),
                            load<Pair>(&knot_half_[k + 1])};
    Sums sums = sums_[k / 2];
    const Rows* rows = &rows_[k / 2 * axes];
    for (std::size_t a = 0; a < axes; ++a) {
      const Pair* f = rows[a].f;
      const auto use = [&](const Pair* row) { return row[0] * q0 + row[1] * q1 + row[2] * q2; };
      sums.keep_knot(f, f[0] * q0 + f[1] * q1, mu);
      const Pair* middle = f + kMiddle;
      sums.keep(middle[0], middle[1], middle[2], use(middle), mu);
      // The jerk is what the row makes by the root of b.
      for (std::size_t place = 0; place < 3; ++place) {
        const Pair* row = f + kJerk + 3 * place;
        const Pair root = roots[place], e = use(row), by = halves[place] * e;
        const double(&w)[3] = kAt[place];
        sums.keep(root * row[0] + by * w[0], root * row[1] + by * w[1], root * row[2] + by * w[2], e * root,
                  mu);
      }
    }
    sums_[k / 2] = sums;
  }
}

/// Sums of knots to gradient and matrix.
void SpeedLaw::gather() {
  const auto size = static_cast<std::size_t>(intervals_) + 2;
  for (auto* v : {&gradient_, &h0_, &h1_, &h2_}) v->assign(size + 2, 0.0);
  for (std::size_t k = 0; k + 1 < size; ++k) {
    const Sums& from = sums_[k / 2];
    const std::size_t lane = k % 2;
    gradient_[k] += from.g0[lane];
    gradient_[k + 1] += from.g1[lane];
    gradient_[k + 2] += from.g2[lane];
    h0_[k] += from.h00[lane];
    h1_[k] += from.h01[lane];
    h2_[k] += from.h02[lane];
    h0_[k + 1] += from.h11[lane];
    h1_[k + 1] += from.h12[lane];
    h0_[k + 2] += from.h22[lane];
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
  take_places(beta_);
  derive_time(mu);
  derive_limits(mu);
  gather();
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
    if (d < decrement) return true;
    now = there;
  }
  return true;
}

bool SpeedLaw::descend(double mu, double last) {
  const double rows = row_count();
  for (int round = 0; round < 40; ++round, mu *= kFactor) {
    const bool near = mu * rows < last * time(beta_);
    const double decrement = near ? kLastDecrement : kDecrement;
    if (!centre(mu, kSteps, decrement * mu * static_cast<double>(beta_.size()))) return false;
    if (near) return true;
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
