// SPDX-License-Identifier: Apache-2.0
#include "report/record/path_thinning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servogate::report {

namespace {

double distance(const PathVertex& a, const PathVertex& b) noexcept {
  return std::hypot(double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z);
}

/// Distance of p from the segment a-b.
double off(const PathVertex& p, const PathVertex& a, const PathVertex& b) noexcept {
  const double dx = double{b.x} - a.x, dy = double{b.y} - a.y, dz = double{b.z} - a.z;
  const double px = double{p.x} - a.x, py = double{p.y} - a.y, pz = double{p.z} - a.z;
  const double length2 = dx * dx + dy * dy + dz * dz;
  const double s = length2 > 0 ? std::clamp((px * dx + py * dy + pz * dz) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(px - s * dx, py - s * dy, pz - s * dz);
}

double speed_off(const PathVertex& p, const PathVertex& a, const PathVertex& b) noexcept {
  const double span = double{b.t} - a.t;
  const double s = span > 0 ? (double{p.t} - a.t) / span : 0.0;
  return std::fabs(p.speed - (a.speed + s * (double{b.speed} - a.speed)));
}

bool corner_stone(const std::vector<PathVertex>& path, std::size_t n,
                  const PathThinning& tolerance) noexcept {
  if (n + 1 >= path.size()) return true;
  // The attributes belong to the stretch that ends at a point, so the point before a change has to stay.
  return path[n + 1].kind != path[n].kind || path[n + 1].tool != path[n].tool ||
         (tolerance.keep_lines && path[n + 1].line != path[n].line);
}

void keep_between(const std::vector<PathVertex>& path, std::size_t first, std::size_t last,
                  const PathThinning& tolerance, std::vector<char>& keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double worst = 1.0;
    std::size_t at = 0;
    for (std::size_t n = a + 1; n < b; ++n) {
      const double d = std::max(off(path[n], path[a], path[b]) / tolerance.distance,
                                speed_off(path[n], path[a], path[b]) / tolerance.speed);
      if (d <= worst) continue;
      worst = d;
      at = n;
    }
    if (at == 0) continue;
    keep[at] = 1;
    open.push_back({a, at});
    open.push_back({at, b});
  }
}

}  // namespace

void thin(std::vector<PathVertex>& path, std::size_t from, const PathThinning& tolerance) {
  if (path.size() < from + 3) return;
  std::vector<char> keep(path.size(), 0);
  std::size_t a = from;
  keep[a] = 1;
  for (std::size_t n = from + 1; n < path.size(); ++n) {
    if (!corner_stone(path, n, tolerance)) continue;
    keep[n] = 1;
    keep_between(path, a, n, tolerance, keep);
    a = n;
  }
  std::size_t out = from;
  float deviation = 0;
  for (std::size_t n = from; n < path.size(); ++n) {
    deviation = std::max(deviation, path[n].deviation);
    if (!keep[n]) continue;
    path[out] = path[n];
    path[out++].deviation = std::exchange(deviation, 0.0f);
  }
  path.resize(out);
}

BoundedPath::BoundedPath(std::size_t max_vertices, double tolerance)
    : max_vertices_(std::max<std::size_t>(max_vertices, 16)),
      first_tolerance_(std::max(tolerance, 1e-6)),
      tolerance_(first_tolerance_) {}

PathThinning BoundedPath::thinning() const noexcept {
  // A quarter: the stages of doubling add up to at most twice the last one, and add() leaves out another
  // quarter.
  const double ratio = tolerance_ / first_tolerance_;
  return {tolerance_ / 4, std::max(1e-6, 0.01 * double{fastest_} * std::min(ratio, 100.0)), ratio < 16.0};
}

void BoundedPath::add(const PathVertex& v) {
  fastest_ = std::max(fastest_, v.speed);
  const bool changed =
      !path_.empty() && (v.line != last_.line || v.kind != last_.kind || v.tool != last_.tool);
  if (changed && pending_) keep_last();
  last_ = v;
  left_out_ = std::max(left_out_, v.deviation);
  pending_ = true;
  if (!path_.empty() && distance(v, path_.back()) < first_tolerance_ / 4) return;
  keep_last();
  if (path_.size() - thinned_ > 2 * max_vertices_) compact(2 * max_vertices_);
}

void BoundedPath::keep_last() {
  path_.push_back(last_);
  path_.back().deviation = std::exchange(left_out_, 0.0f);
  pending_ = false;
}

void BoundedPath::compact(std::size_t most) {
  thin(path_, thinned_ > 0 ? thinned_ - 1 : 0, thinning());
  while (path_.size() > most && tolerance_ < 1e6) {
    tolerance_ *= 2;
    thin(path_, 0, thinning());
  }
  thinned_ = path_.size();
}

void BoundedPath::finish() {
  if (pending_ && (path_.empty() || distance(last_, path_.back()) > 0)) keep_last();
  pending_ = false;
  compact(max_vertices_);
}

}  // namespace servogate::report
