// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/tube.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace servogate::bench {
namespace {

constexpr int kBelow = 3 * kCourseAxes;  // of the diagonal, in the band of the Hessian
constexpr std::array kThird{-1.0, 3.0, -3.0, 1.0};
constexpr double kGap = 0.02;    // of the sum of squares, at the end
constexpr double kSofter = 0.1;  // from one weight of the barrier to the next
constexpr int kMostSteps = 40;   // of Newton at one weight

/// Points in units of the tolerance, relative to the programmed ones.
class Tube {
 public:
  Tube(const Line& programmed, double tolerance) : n_(programmed.points.size()), off_(n_), third_(n_) {
    for (std::size_t i = 0; i + 3 < n_; ++i)
      for (int k = 0; k < kCourseAxes; ++k)
        for (std::size_t m = 0; m < 4; ++m)
          third_[i][k] += kThird[m] * programmed.points[i + m][k] / tolerance;
  }

  std::vector<Triple> solve() {
    double weight = 0.1 * squares(off_) / static_cast<double>(n_);
    for (int round = 0; round < 20 && weight > 0.0; ++round, weight *= kSofter) {
      center(weight);
      if (weight * static_cast<double>(n_) < kGap * squares(off_)) break;
    }
    return off_;
  }

 private:
  using Band = std::array<double, kBelow + 1>;  // row: diagonal first, then to the left

  Triple bend(const std::vector<Triple>& off, std::size_t i) const {
    Triple out = third_[i];
    for (int k = 0; k < kCourseAxes; ++k)
      for (std::size_t m = 0; m < 4; ++m) out[k] += kThird[m] * off[i + m][k];
    return out;
  }

  double squares(const std::vector<Triple>& off) const {
    double sum = 0.0;
    for (std::size_t i = 0; i + 3 < n_; ++i)
      for (const double x : bend(off, i)) sum += x * x;
    return sum;
  }

  static double room(const Triple& off) { return 1.0 - off[0] * off[0] - off[1] * off[1] - off[2] * off[2]; }

  double cost(const std::vector<Triple>& off, double weight) const {
    double barrier = 0.0;
    for (const Triple& o : off) {
      if (!(room(o) > 0.0)) return HUGE_VAL;
      barrier -= std::log(room(o));
    }
    return squares(off) + weight * barrier;
  }

  void derive(double weight) {
    g_.assign(n_ * kCourseAxes, 0.0);
    h_.assign(n_ * kCourseAxes, Band{});
    for (std::size_t i = 0; i + 3 < n_; ++i) {
      const Triple x = bend(off_, i);
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t k = 0; k < kCourseAxes; ++k) {
          const std::size_t row = (i + a) * kCourseAxes + k;
          g_[row] += 2.0 * kThird[a] * x[k];
          for (std::size_t b = 0; b <= a; ++b) h_[row][(a - b) * kCourseAxes] += 2.0 * kThird[a] * kThird[b];
        }
    }
    for (std::size_t i = 0; i < n_; ++i) {
      const double s = room(off_[i]);
      for (std::size_t k = 0; k < kCourseAxes; ++k) {
        const std::size_t row = i * kCourseAxes + k;
        g_[row] += 2.0 * weight * off_[i][k] / s;
        h_[row][0] += 2.0 * weight / s;
        for (std::size_t m = 0; m <= k; ++m)
          h_[row][k - m] += 4.0 * weight * off_[i][k] * off_[i][m] / (s * s);
      }
    }
    // The ends stay where they are.
    for (std::size_t k = 0; k < kCourseAxes; ++k)
      for (const std::size_t row : {k, (n_ - 1) * kCourseAxes + k}) {
        g_[row] = 0.0;
        h_[row] = Band{};
        h_[row][0] = 1.0;
        for (std::size_t below = row + 1; below < std::min(row + kBelow + 1, g_.size()); ++below)
          h_[below][below - row] = 0.0;
      }
  }

  /// L L' in the band; gives Newton's decrement.
  double newton() {
    const std::size_t m = g_.size();
    step_.assign(m, 0.0);
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t most = std::min<std::size_t>(i, kBelow);
      for (std::size_t d = most + 1; d-- > 0;) {
        const std::size_t j = i - d;
        double sum = h_[i][d];
        for (std::size_t e = d + 1; e <= most && e - d <= kBelow; ++e) sum -= h_[i][e] * h_[j][e - d];
        h_[i][d] = d > 0 ? sum / h_[j][0] : std::sqrt(std::max(sum, 1e-300));
      }
      double y = -g_[i];
      for (std::size_t d = 1; d <= most; ++d) y -= h_[i][d] * step_[i - d];
      step_[i] = y / h_[i][0];
    }
    for (std::size_t i = m; i-- > 0;) {
      step_[i] /= h_[i][0];
      for (std::size_t d = 1; d <= std::min<std::size_t>(i, kBelow); ++d) step_[i - d] -= h_[i][d] * step_[i];
    }
    double decrement = 0.0;
    for (std::size_t i = 0; i < m; ++i) decrement -= g_[i] * step_[i];
    return decrement;
  }

  void center(double weight) {
    double now = cost(off_, weight);
    for (int n = 0; n < kMostSteps; ++n) {
      derive(weight);
      const double decrement = newton();
      if (!(decrement > 1e-3 * weight * static_cast<double>(n_))) return;
      double then = HUGE_VAL;
      for (double share = 1.0; share > 1e-6; share *= 0.5) {
        trial_ = off_;
        for (std::size_t i = 0; i < n_; ++i)
          for (std::size_t k = 0; k < kCourseAxes; ++k) trial_[i][k] += share * step_[i * kCourseAxes + k];
        then = cost(trial_, weight);
        if (then < now - 1e-4 * share * decrement) break;
      }
      if (!(then < now)) return;
      off_.swap(trial_);
      now = then;
    }
  }

  std::size_t n_;
  std::vector<Triple> off_, third_, trial_;
  std::vector<double> g_, step_;
  std::vector<Band> h_;
};

}  // namespace

Line smoothest(const Line& programmed, double tolerance) {
  const std::vector<Triple> off = Tube(programmed, tolerance).solve();
  Line out = programmed;
  for (std::size_t i = 0; i < off.size(); ++i)
    for (std::size_t k = 0; k < kCourseAxes; ++k) out.points[i][k] += tolerance * off[i][k];
  return out;
}

Course course_of(const Line& line, double feed) {
  const std::vector<Triple>& x = line.points;
  const std::size_t n = x.size();
  const double h = line.step;
  const auto place = [&](std::size_t i) {
    const std::size_t c = std::clamp<std::size_t>(i, 2, n - 3);
    Place out;
    double rate = 0.0;
    for (int k = 0; k < kCourseAxes; ++k) {
      out.d1[k] = (x[c + 1][k] - x[c - 1][k]) / (2.0 * h);
      out.d2[k] = (x[c + 1][k] - 2.0 * x[c][k] + x[c - 1][k]) / (h * h);
      out.d3[k] = (x[c + 2][k] - 2.0 * x[c + 1][k] + 2.0 * x[c - 1][k] - x[c - 2][k]) / (2.0 * h * h * h);
      rate += out.d1[k] * out.d1[k];
    }
    out.s = static_cast<double>(i) * h;
    out.cap = feed / std::sqrt(rate);
    return out;
  };
  // Rest asks for places ever closer within the first step and the last one.
  std::vector<double> near;
  for (const double s : graded(100.0 * h, h))
    if (s < 0.8 * h) near.push_back(s);
  Course out;
  const double length = static_cast<double>(n - 1) * h;
  for (const double s : near) {
    out.push_back(place(0));
    out.back().s = s;
  }
  for (std::size_t i = 1; i + 1 < n; ++i) out.push_back(place(i));
  for (std::size_t k = near.size(); k-- > 0;) {
    out.push_back(place(n - 1));
    out.back().s = length - near[k];
  }
  return out;
}

}  // namespace servogate::bench
