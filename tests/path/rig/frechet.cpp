// SPDX-License-Identifier: Apache-2.0
#include "tests/path/rig/frechet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::path::test {
namespace {

struct Interval {
  double low = 1.0, high = 0.0;
  bool empty() const { return low > high; }
};

/// Part of the segment p-q (as shares of it) that is within r of c.
Interval near(const Vector& p, const Vector& q, const Vector& c, double r, int axes) {
  double a = 0.0, b = 0.0, d = -r * r;
  for (int i = 0; i < axes; ++i) {
    const double u = q[i] - p[i], w = p[i] - c[i];
    a += u * u;
    b += u * w;
    d += w * w;
  }
  if (a < 1e-30) return d <= 0.0 ? Interval{0.0, 1.0} : Interval{};
  const double disc = b * b - a * d;
  if (disc < 0.0) return {};
  const double root = std::sqrt(disc);
  Interval out{std::max(0.0, (-b - root) / a), std::min(1.0, (-b + root) / a)};
  return out;
}

double distance(const Vector& p, const Vector& q, int axes) {
  double sum = 0.0;
  for (int i = 0; i < axes; ++i) sum += (p[i] - q[i]) * (p[i] - q[i]);
  return std::sqrt(sum);
}

void add_arc(Polyline& out, const Element& e, int axes, double sagitta) {
  const Vector from = out.back();
  const double x = from[e.axis1] - e.center1, y = from[e.axis2] - e.center2, r = std::hypot(x, y);
  const double sweep = e.sweep_deg * std::numbers::pi / 180.0, begin = std::atan2(y, x);
  const double step = 2.0 * std::acos(std::max(0.0, 1.0 - sagitta / r));
  const int n = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / step)));
  for (int k = 1; k < n; ++k) {
    const double share = static_cast<double>(k) / n;
    Vector p{};
    for (int i = 0; i < axes; ++i) p[i] = from[i] + share * (e.to[i] - from[i]);
    p[e.axis1] = e.center1 + r * std::cos(begin + share * sweep);
    p[e.axis2] = e.center2 + r * std::sin(begin + share * sweep);
    out.push_back(p);
  }
  out.push_back(e.to);
}

}  // namespace

Polyline programmed_path(const Vector& start, const std::vector<Element>& elements, int axes,
                         double sagitta) {
  Polyline out{start};
  for (const Element& e : elements) {
    if (e.kind == Element::Kind::arc)
      add_arc(out, e, axes, sagitta);
    else
      out.push_back(e.to);
  }
  return out;
}

bool frechet_within(const Polyline& a, const Polyline& b, double r, int axes) {
  if (distance(a.front(), b.front(), axes) > r || distance(a.back(), b.back(), axes) > r) return false;
  const std::size_t m = b.size() - 1;
  std::vector<Interval> left(m), right(m);
  // Column 0: b may run on as long as it stays near a's first point.
  for (std::size_t j = 0; j < m; ++j) {
    left[j] = near(b[j], b[j + 1], a[0], r, axes);
    if (left[j].low > 0.0 || left[j].empty()) {
      left[j] = {};
      break;
    }
    if (left[j].high < 1.0) break;
  }
  std::size_t first = 0, reached = m;  // cells of a column outside of them are empty
  bool bottom_row = true;
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    Interval bottom;
    if (bottom_row) {
      bottom = near(a[i], a[i + 1], b[0], r, axes);
      if (bottom.empty() || bottom.low > 0.0) bottom = {};
      bottom_row = !bottom.empty() && bottom.high >= 1.0;
    }
    while (first < m && left[first].empty() && !(first == 0 && !bottom.empty())) ++first;
    if (first == m) return false;
    std::size_t j = first, last_left = first;
    for (std::size_t k = first; k < reached; ++k)
      if (!left[k].empty()) last_left = k;
    std::size_t touched = j;
    for (; j < m && (j <= last_left || !bottom.empty()); ++j) {
      const Interval free_right = near(b[j], b[j + 1], a[i + 1], r, axes);
      const Interval free_top = near(a[i], a[i + 1], b[j + 1], r, axes);
      Interval reach_right, reach_top;
      if (!bottom.empty())
        reach_right = free_right;
      else if (!left[j].empty())
        reach_right = {std::max(free_right.low, left[j].low), free_right.high};
      if (!left[j].empty())
        reach_top = free_top;
      else if (!bottom.empty())
        reach_top = {std::max(free_top.low, bottom.low), free_top.high};
      right[j] = reach_right;
      bottom = reach_top;
      touched = j + 1;
    }
    for (std::size_t k = first; k < touched; ++k) {
      left[k] = right[k];
      right[k] = {};
    }
    reached = touched;
  }
  return !left[m - 1].empty() && left[m - 1].high >= 1.0 - 1e-9;
}

}  // namespace servogate::path::test
