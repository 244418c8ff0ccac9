// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/optimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace servogate::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFirstStep = 1e-7;  // mm: 0.4 ms from rest at 10 000 mm/s3
constexpr double kGrowth = 1.3;      // from one step to the next
constexpr int kMostSteps = 60;       // of Newton at one weight of the barrier
constexpr double kGap = 3e-4;        // of the time, at the end
constexpr double kSofter = 0.2;      // from one weight to the next
constexpr double kDecrement = 0.1;   // of Newton, per step: good enough to go on

constexpr double kLeastPivot = 1e-12;  // of the diagonal; what is less is rounding

/// A linear form of b at three neighbours.
using Form = std::array<double, 3>;

/// What holds at one inner place: |row b| <= bound, and the same with a bound that goes with 1 / sqrt(b).
struct Row {
  Form form{};
  double bound = 0.0;
  bool jerk = false;
};

class Problem {
 public:
  Problem(const Course& course, const Limits& limits, bool with_jerk)
      : n_(course.size()), top_(n_, kInfinity) {
    for (std::size_t i = 0; i + 1 < n_; ++i) steps_.push_back(course[i + 1].s - course[i].s);
    first_.assign(n_ + 1, 0);
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      const Place& p = course[i];
      double fastest = p.cap;
      for (int k = 0; k < kCourseAxes; ++k)
        if (std::abs(p.d1[k]) > 0.0) fastest = std::min(fastest, limits.velocity[k] / std::abs(p.d1[k]));
      top_[i] = fastest * fastest;
      add_rows(p, limits, i, with_jerk);
      first_[i + 1] = rows_.size();
    }
    first_[n_] = rows_.size();
    if (with_jerk) begin_with_jerk(course, limits);
  }

  Optimum solve() {
    begin();
    Optimum out;
    const double count = 2.0 * static_cast<double>(rows_.size() + n_);
    for (double weight = time(b_) / count; !out.converged; weight *= kSofter) {
      if (!center(weight)) break;
      out.seconds = time(b_);
      out.gap = weight * count;
      out.converged = out.gap < kGap * out.seconds;
    }
    return out;
  }

 private:
  void add_rows(const Place& p, const Limits& limits, std::size_t i, bool with_jerk) {
    const double h = steps_[i - 1], k = steps_[i], sum = h + k;
    const Form one{0.0, 1.0, 0.0};
    const Form slope{-k / (h * sum), (k - h) / (h * k), h / (k * sum)};
    const Form bend{2.0 / (h * sum), -2.0 / (h * k), 2.0 / (k * sum)};
    for (int axis = 0; axis < kCourseAxes; ++axis) {
      const double d1 = p.d1[axis], d2 = p.d2[axis], d3 = p.d3[axis];
      if (std::abs(d1) + std::abs(d2) + std::abs(d3) < 1e-12) continue;
      Row a, j;
      for (int m = 0; m < 3; ++m) {
        a.form[m] = d2 * one[m] + 0.5 * d1 * slope[m];
        j.form[m] = d3 * one[m] + 1.5 * d2 * slope[m] + 0.5 * d1 * bend[m];
      }
      a.bound = limits.acceleration[axis];
      rows_.push_back(a);
      j.bound = limits.jerk[axis];
      j.jerk = true;
      if (with_jerk) rows_.push_back(j);
    }
  }

  /// Acceleration is 0 at both ends: no place next to them is passed faster than jerk alone makes it from
  /// rest, j t^3 / 6 = s. The rows of places see b, and not what happens before the first one.
  void begin_with_jerk(const Course& course, const Limits& limits) {
    constexpr std::size_t kNext = 2;
    for (const bool end : {false, true}) {
      const Place& rest = end ? course.back() : course.front();
      double j = kInfinity;
      for (int k = 0; k < kCourseAxes; ++k)
        if (std::abs(rest.d1[k]) > 1e-9) j = std::min(j, limits.jerk[k] / std::abs(rest.d1[k]));
      for (std::size_t n = 1; n <= kNext && n + 1 < n_; ++n) {
        const std::size_t i = end ? n_ - 1 - n : n;
        const double speed = 0.5 * j * std::pow(6.0 * std::abs(course[i].s - rest.s) / j, 2.0 / 3.0);
        top_[i] = std::min(top_[i], speed * speed);
      }
    }
  }

  /// The same slow law for every limit, far inside.
  void begin() {
    double length = 0.0, at = 0.0;
    for (const double h : steps_) length += h;
    b_.assign(n_, 0.0);
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      at += steps_[i - 1];
      b_[i] = std::pow(4.0 * at * (length - at) / (length * length), 4.0 / 3.0);
    }
    double shrink = kInfinity;
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      shrink = std::min(shrink, 0.5 * top_[i] / b_[i]);
      for (std::size_t r = first_[i]; r < first_[i + 1]; ++r) {
        const double value = std::abs(form(rows_[r], b_, i)) * (rows_[r].jerk ? std::sqrt(b_[i]) : 1.0);
        if (value > 0.0)
          shrink = std::min(shrink, std::pow(0.5 * rows_[r].bound / value, rows_[r].jerk ? 2.0 / 3.0 : 1.0));
      }
    }
    for (double& b : b_) b *= shrink;
  }

  static double form(const Row& row, const std::vector<double>& b, std::size_t i) {
    return row.form[0] * b[i - 1] + row.form[1] * b[i] + row.form[2] * b[i + 1];
  }

  double time(const std::vector<double>& b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < n_; ++i) sum += 2.0 * steps_[i] / (std::sqrt(b[i]) + std::sqrt(b[i + 1]));
    return sum;
  }

  /// Time and barrier; infinite outside.
  double cost(const std::vector<double>& b, double weight) const {
    double barrier = 0.0, product = 1.0;
    const auto keep = [&](double slack) {  // few logarithms
      product *= slack;
      if (product < 1e-200 || product > 1e200) {
        barrier -= std::log(product);
        product = 1.0;
      }
    };
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      if (!(b[i] > 0.0) || !(b[i] < top_[i])) return kInfinity;
      keep(1.0 - b[i] / top_[i]);
      keep(b[i]);
      const double root = std::sqrt(b[i]);
      for (std::size_t r = first_[i]; r < first_[i + 1]; ++r) {
        const double share = form(rows_[r], b, i) * (rows_[r].jerk ? root : 1.0) / rows_[r].bound;
        if (!(std::abs(share) < 1.0)) return kInfinity;
        keep(1.0 - share * share);
      }
    }
    return time(b) + weight * (barrier - std::log(product));
  }

  void derive(double weight) {
    g_.assign(n_, 0.0);
    for (auto* d : {&h0_, &h1_, &h2_}) d->assign(n_, 0.0);
    for (std::size_t i = 0; i + 1 < n_; ++i) {
      const double x = std::max(b_[i], 1e-300), y = std::max(b_[i + 1], 1e-300);
      const double u = std::sqrt(x), v = std::sqrt(y), q = 1.0 / (u + v), t = 2.0 * steps_[i] * q * q;
      if (i > 0) {
        g_[i] -= t * 0.5 / u;
        h0_[i] += t * (0.5 * q / x + 0.25 / (u * x));
      }
      if (i + 2 < n_) {
        g_[i + 1] -= t * 0.5 / v;
        h0_[i + 1] += t * (0.5 * q / y + 0.25 / (v * y));
      }
      if (i > 0 && i + 2 < n_) h1_[i] += t * 0.5 * q / (u * v);
    }
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      push(i, {0.0, -1.0, 0.0}, top_[i] - b_[i], weight);
      push(i, {0.0, 1.0, 0.0}, b_[i], weight);
      const double root = std::sqrt(b_[i]);
      for (std::size_t r = first_[i]; r < first_[i + 1]; ++r) {
        const Row& row = rows_[r];
        const double f = form(row, b_, i), scale = row.jerk ? root : 1.0;
        const double moves = row.jerk ? 0.5 * f / root : 0.0;  // the bound goes with b, too
        const Form d{scale * row.form[0], scale * row.form[1] + moves, scale * row.form[2]};
        push(i, {-d[0], -d[1], -d[2]}, row.bound - scale * f, weight);
        push(i, d, row.bound + scale * f, weight);
      }
    }
  }

  /// Adds -weight log(slack), whose slope is `d`.
  void push(std::size_t i, const Form& d, double slack, double weight) {
    const double first = weight / slack, second = first / slack;
    const bool before = i > 1, behind = i + 2 < n_;
    g_[i] -= first * d[1];
    h0_[i] += second * d[1] * d[1];
    if (before) {
      g_[i - 1] -= first * d[0];
      h0_[i - 1] += second * d[0] * d[0];
      h1_[i - 1] += second * d[0] * d[1];
    }
    if (behind) {
      g_[i + 1] -= first * d[2];
      h0_[i + 1] += second * d[2] * d[2];
      h1_[i] += second * d[1] * d[2];
    }
    if (before && behind) h2_[i - 1] += second * d[0] * d[2];
  }

  /// Solves the pentadiagonal system for the step; gives Newton's decrement.
  double newton() {
    const std::size_t m = n_ - 2;
    step_.assign(n_, 0.0);
    // L D L': l1, l2 below the diagonal, in place of h1, h2.
    for (std::size_t k = 0; k < m; ++k) {
      const std::size_t i = k + 1;
      double d = h0_[i], l1 = h1_[i];
      if (k >= 1) {
        d -= h1_[i - 1] * h1_[i - 1] * h0_[i - 1];
        l1 -= h2_[i - 1] * h1_[i - 1] * h0_[i - 1];
      }
      if (k >= 2) d -= h2_[i - 2] * h2_[i - 2] * h0_[i - 2];
      d = std::max(d, kLeastPivot * h0_[i]);
      h0_[i] = d;
      h1_[i] = l1 / d;
      h2_[i] /= d;
    }
    for (std::size_t i = 1; i <= m; ++i) {
      double y = -g_[i];
      if (i >= 2) y -= h1_[i - 1] * step_[i - 1];
      if (i >= 3) y -= h2_[i - 2] * step_[i - 2];
      step_[i] = y;
    }
    for (std::size_t i = m; i >= 1; --i) {
      double y = step_[i] / h0_[i];
      if (i + 1 <= m) y -= h1_[i] * step_[i + 1];
      if (i + 2 <= m) y -= h2_[i] * step_[i + 2];
      step_[i] = y;
    }
    double decrement = 0.0;
    for (std::size_t i = 1; i <= m; ++i) decrement -= g_[i] * step_[i];
    return decrement;
  }

  bool center(double weight) {
    double now = cost(b_, weight);
    for (int n = 0; n < kMostSteps; ++n) {
      derive(weight);
      const double decrement = newton();
      if (!std::isfinite(decrement) || decrement < 0.0) return false;
      if (decrement < kDecrement * weight * static_cast<double>(n_) * 0.01) return true;
      double share = 1.0;
      for (std::size_t i = 1; i + 1 < n_; ++i)
        if (step_[i] < 0.0) share = std::min(share, -0.95 * b_[i] / step_[i]);
      double then = kInfinity;
      for (; share > 1e-10; share *= 0.6) {
        trial_ = b_;
        for (std::size_t i = 1; i + 1 < n_; ++i) trial_[i] += share * step_[i];
        then = cost(trial_, weight);
        if (then < now - 1e-4 * share * decrement) break;
      }
      if (!(then < now)) return true;  // rounding
      b_.swap(trial_);
      now = then;
    }
    return true;
  }

  std::size_t n_;
  std::vector<double> steps_, top_;
  std::vector<Row> rows_;
  std::vector<std::size_t> first_;  ///< of rows_, by place
  std::vector<double> b_, trial_, g_, h0_, h1_, h2_, step_;
};

}  // namespace

std::vector<double> graded(double length, double spacing) {
  std::vector<double> up{0.0};
  for (double step = kFirstStep; step < spacing && up.back() < 0.25 * length; step *= kGrowth)
    up.push_back(up.back() + step);
  const double rest = length - 2.0 * up.back();
  const int even = static_cast<int>(std::ceil(rest / spacing));
  std::vector<double> out = up;
  for (int k = 1; k < even; ++k) out.push_back(up.back() + rest * k / even);
  for (std::size_t k = up.size(); k-- > 0;) out.push_back(length - up[k]);
  return out;
}

Optimum fastest(const Course& course, const Limits& limits, bool with_jerk) {
  return Problem(course, limits, with_jerk).solve();
}

}  // namespace servogate::bench
