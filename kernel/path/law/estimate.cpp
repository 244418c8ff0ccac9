// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kUnknown = 1e30;
constexpr double kLargestScale = 60.0;  // mm
constexpr double kSlope = 1.4;          // of the square of speed, in accelerations
constexpr int kLeast = 6, kMean = 3;    // steps to each side: least of them, and mean of them, three times
constexpr std::size_t kEdge = 20;       // steps at the ends of a run whose least is not taken
constexpr std::size_t kPast = 24;
constexpr std::size_t kFewest = 12;  // steps of a run
constexpr double kTrials = 8.0;      // the first window is so much shorter than the full one
constexpr double kRest = 0.5;        // of a window: less than that behind it belongs to it
constexpr std::size_t kFewestDecided = 64, kBeyond = 16;  // steps in it, and behind them for the means

// y(v) by the root of jerk: the length in which jerk alone reaches v, from rest.
double y_of(double v) { return std::sqrt(2.0) / 3.0 * v * std::sqrt(v); }
double v_of(double y) {
  const double c = std::cbrt(3.0 / std::sqrt(2.0) * y);
  return c * c;
}
const double kTime = std::cbrt(9.0 / 2.0);  // v = kTime y^(2/3)

/// Time over `h` while y goes linearly.
double time_over(double y0, double y1, double h) {
  if (std::abs(y1 - y0) < 1e-9 * (y0 + y1)) return h / v_of(0.5 * (y0 + y1));
  return 3.0 * h / kTime * (std::cbrt(y1) - std::cbrt(y0)) / (y1 - y0);
}

}  // namespace

void ClockEstimate::clear(double step) { *this = ClockEstimate(axes_, *transformation_, step); }

bool ClockEstimate::work(const Run& run, bool ended, Kept<double>& places) {
  if (done_ || run.empty()) return false;
  if (places.end() == 0) {
    places.push_back(0.0);
    begin_y_ = y_of(run.begin_speed());
  }
  if (!window(run, ended)) return false;
  integrate(run, places);
  return true;
}

/// The fastest feed of the legs between, and the least limits of the axes that they move.
void ClockEstimate::look_at_limits(const Run& run, std::size_t first, double end) {
  slowest_ = {kInfinite, kInfinite, kInfinite};
  feed_ = 0.0;
  for (std::size_t k = first; k < run.end() && (k == first || run.leg(k).begin < end); ++k) {
    feed_ = std::max(feed_, fastest(run.leg(k), axes_));
    for (std::size_t i = 0; i < static_cast<std::size_t>(axes_); ++i) {
      if (!moves(run.leg(k), i)) continue;
      slowest_.acceleration = std::min(slowest_.acceleration, (*run.leg(k).limits)[i].acceleration);
      slowest_.jerk = std::min(slowest_.jerk, (*run.leg(k).limits)[i].jerk);
    }
  }
}

/// Length in which a stop from a speed and all that is looked at on the way are over.
double ClockEstimate::reach(double v) const {
  const double a = slowest_.acceleration, j = slowest_.jerk;
  const double scales = 3.0 * std::min(kLargestScale, 1.0 + v * a / j);
  return v * v / kSlope / a + y_of(v) / std::sqrt(j) + scales + 20.0 * v * step_;
}

double ClockEstimate::full_window() const {
  return reach(feed_) + std::max(reach(feed_), static_cast<double>(kFewestDecided) * feed_ * step_);
}

/// One window, when all that it looks at is known. A short one is enough where the path is slow: what lies
/// before a place that a rest at the window's end does not touch is decided.
bool ClockEstimate::window(const Run& run, bool ended) {
  if (decided_) return false;
  const std::size_t first = run.leg_at(begin_, run.first());
  if (trial_ == 0.0) {
    look_at_limits(run, first, begin_);
    trial_ = full_window() / kTrials;
  }
  for (;; trial_ *= 2.0) {
    const double end = begin_ + trial_, known = end + kRest * trial_;
    const bool last = ended && run.length() <= known;
    if (!last && run.length() <= known) return false;
    look_at_limits(run, first, last ? run.length() : end);
    const bool full = trial_ >= full_window();
    solve(run, last ? run.length() : end, last);
    if (!last && !full && trial_ < reach(reached_)) continue;
    if (commit(last, full ? 1 : kFewestDecided)) break;
  }
  trial_ = 0.0;
  return true;
}

void ClockEstimate::solve(const Run& run, double end, bool last) {
  origin_ = begin_;
  sample(run, end);
  cap_by_limits();
  limit_cap_ = cap_;
  const int n = static_cast<int>(at_.size()) - 1;
  for (int h = 1; h < n / 3 && h * spacing_ <= kLargestScale; h = h < 4 ? h + 1 : h * 5 / 4) cap_by_scale(h);
  carry_caps();
  free_straights(run);
  nodes(run, end, last);
  reach_between();
  raw_steps(end, last);
  smooth(last);
}

void ClockEstimate::sample(const Run& run, double end) {
  double shortest = kInfinite;
  const std::size_t first = run.leg_at(begin_, run.first());
  for (std::size_t k = first; k < run.end() && run.leg(k).begin < end; ++k)
    shortest = std::min(shortest, run.leg(k).piece.length);
  const double longest = 0.2 * step_ * feed_ + 0.02;
  const double wanted = std::clamp(0.5 * shortest, std::min(0.005, longest), longest);
  const auto n = static_cast<std::size_t>(std::max(12.0, std::ceil((end - begin_) / wanted)));
  spacing_ = (end - begin_) / static_cast<double>(n);
  at_.resize(n + 1);
  legs_.resize(n + 1);
  feeds_.resize(n + 1);
  std::size_t leg = first;
  for (std::size_t i = 0; i <= n; ++i) {
    const double u = std::min(end, begin_ + static_cast<double>(i) * spacing_);
    leg = run.leg_at(u, leg);
    legs_[i] = &run.leg(leg);
    at_[i] = run.at(u, leg);
    feeds_[i] = feed_at(*legs_[i], at_[i], u);
    if (transformation_ != &identity()) at_[i] = to_axes(*transformation_, at_[i], axes_);
  }
}

/// What feed and velocity allow, and how fast acceleration and jerk change that along the path.
void ClockEstimate::cap_by_limits() {
  const std::size_t n = at_.size() - 1;
  cap_.assign(n + 1, 0.0);
  jerk_root_.assign(n + 1, 0.0);
  acceleration_.assign(n + 1, 0.0);
  for (std::size_t i = 0; i <= n; ++i) {
    const std::size_t from = std::min(i, n - 1);
    double v = feeds_[i], a = kUnknown, j = kUnknown;
    for (int k = 0; k < axes_; ++k) {
      const double rate = std::abs(at_[from + 1][k] - at_[from][k]) / spacing_;
      if (rate < 1e-12) continue;
      const AxisLimits& limits = (*legs_[i]->limits)[k];
      v = std::min(v, limits.velocity / rate);
      a = std::min(a, limits.acceleration / rate);
      j = std::min(j, limits.jerk / rate);
    }
    cap_[i] = std::min(v, feed_);
    acceleration_[i] = a;
    jerk_root_[i] = std::sqrt(j);
  }
}

/// What third and second differences over a spacing allow, less what the tolerance takes away.
void ClockEstimate::cap_by_scale(int h) {
  const std::size_t n = at_.size() - 1, d = static_cast<std::size_t>(h);
  const double l = h * spacing_;
  const std::size_t stride = std::max<std::size_t>(1, d / 2);
  for (std::size_t i = 0; i + 3 * d <= n; i += stride) {
    const Vector &p = at_[i], &q = at_[i + d], &r = at_[i + 2 * d], &s = at_[i + 3 * d];
    const double tolerance = legs_[i]->tolerance;
    double time3 = 0.0, time2 = 0.0;
    for (int k = 0; k < axes_; ++k) {
      const AxisLimits& limits = (*legs_[i]->limits)[k];
      const double e3 = std::abs(s[k] - p[k] + 3.0 * (q[k] - r[k])) - 5.0 * tolerance;
      const double e2 = std::abs(r[k] - 2.0 * q[k] + p[k]) - 3.0 * tolerance;
      if (e3 > 0.0) time3 = std::max(time3, e3 / limits.jerk);
      if (e2 > 0.0) time2 = std::max(time2, e2 / limits.acceleration);
    }
    if (time3 == 0.0 && time2 == 0.0) continue;
    const double v = l / std::max(std::cbrt(time3), std::sqrt(time2));
    if (v >= feed_) continue;
    for (std::size_t k = i; k <= i + 3 * d; ++k) cap_[k] = std::min(cap_[k], v);
  }
}

/// Differences that began before this window were taken in the last one.
void ClockEstimate::carry_caps() {
  for (std::size_t i = 0; i < cap_.size() && !old_cap_.empty(); ++i) {
    const double at = (origin_ + static_cast<double>(i) * spacing_ - old_origin_) / old_spacing_;
    const auto k = static_cast<std::size_t>(std::max(0.0, at));
    if (k + 1 >= old_cap_.size()) break;
    cap_[i] = std::min({cap_[i], old_cap_[k], old_cap_[k + 1]});
  }
}

/// Where a run flies in or out along a line, only the limits count: differences reach far from the corner.
void ClockEstimate::free_straights(const Run& run) {
  constexpr double kFree = 0.7;  // of the first and the last leg
  const bool in = run.begin_speed() > 0.0, out = run.end_speed() > 0.0;
  for (std::size_t i = 0; i < cap_.size(); ++i) {
    const double u = origin_ + static_cast<double>(i) * spacing_, length = legs_[i]->piece.length;
    const bool first = in && legs_[i]->begin == 0.0 && u < kFree * length;
    const bool last = out && legs_[i]->end() == run.length() && u > run.length() - kFree * length;
    if (first || last) cap_[i] = limit_cap_[i];
  }
}

std::size_t ClockEstimate::sample_at(double u) const {
  const double at = std::max(0.0, (u - origin_) / spacing_);
  return std::min(static_cast<std::size_t>(at), cap_.size() - 2);
}

void ClockEstimate::nodes_around(double u, double y, double end) {
  nodes_.push_back({u, y});
  const double tolerance = legs_[sample_at(u)]->tolerance;
  for (double s = 0.5 * tolerance; s < 2.0 * spacing_; s *= 1.5) {
    if (u + s < end) nodes_.push_back({u + s, kUnknown});
    if (u - s > begin_) nodes_.push_back({u - s, kUnknown});
  }
}

void ClockEstimate::sharp_corners(const Run& run, double end) {
  for (std::size_t k = run.leg_at(begin_, run.first()); k + 1 < run.end(); ++k) {
    const Leg &before = run.leg(k), &after = run.leg(k + 1);
    if (after.begin >= end) break;
    if (after.begin <= begin_) continue;
    const double room = 2.5 * std::min(before.tolerance, after.tolerance);
    const Vector t0 =
        turned_to_axes(*transformation_, evaluate(before.piece, before.piece.length, axes_).d1, axes_);
    const Vector t1 = turned_to_axes(*transformation_, evaluate(after.piece, 0.0, axes_).d1, axes_);
    double most = 1e-9, v = feed_;
    for (int i = 0; i < axes_; ++i) {
      const double turn = std::abs(t1[i] - t0[i]);
      if (turn < 1e-9) continue;
      most = std::max(most, turn);
      const AxisLimits& limits = (*after.limits)[i];
      v = std::min({v, 1.5 * room / turn * std::cbrt(2.0 * limits.jerk / room),
                    2.0 * room / turn * std::sqrt(limits.acceleration / room)});
    }
    const bool sharp = 1.5 * room / most <= std::min(before.piece.length, after.piece.length);
    if (after.corner < feed_) v = sharp ? std::min(v, after.corner) : after.corner;
    if ((sharp || after.corner < feed_) && v < feed_) nodes_around(after.begin, y_of(v), end);
  }
}

void ClockEstimate::nodes(const Run& run, double end, bool last) {
  nodes_.clear();
  const std::size_t n = cap_.size() - 1;
  for (std::size_t i = 0; i <= n; ++i)
    nodes_.push_back({origin_ + static_cast<double>(i) * spacing_, y_of(cap_[i])});
  nodes_.front().y = begin_y_;
  const double out = last ? run.end_speed() : 0.0;
  nodes_.back() = {end, y_of(out)};
  sharp_corners(run, end);
  if (begin_y_ == 0.0) nodes_around(begin_, 0.0, end);
  if (last && out == 0.0) nodes_around(end, 0.0, end);
  std::stable_sort(nodes_.begin(), nodes_.end(), [](const Node& p, const Node& q) { return p.u < q.u; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    if (nodes_[i].u > nodes_[kept].u + 1e-7)
      nodes_[++kept] = nodes_[i];
    else
      nodes_[kept].y = std::min(nodes_[kept].y, nodes_[i].y);
  }
  nodes_.resize(kept + 1);
  for (Node& node : nodes_) {
    const std::size_t k = sample_at(node.u);
    if (node.y == kUnknown) node.y = y_of(std::min(cap_[k], cap_[k + 1]));
  }
}

double ClockEstimate::reached(const Node& from, const Node& to) const {
  const std::size_t k = sample_at(0.5 * (from.u + to.u));
  const double h = std::abs(to.u - from.u), v = v_of(from.y);
  const double by_acceleration = y_of(std::sqrt(v * v + kSlope * acceleration_[k] * h));
  return std::min({to.y, from.y + jerk_root_[k] * h, by_acceleration});
}

void ClockEstimate::reach_between() {
  for (std::size_t i = 1; i < nodes_.size(); ++i) nodes_[i].y = reached(nodes_[i - 1], nodes_[i]);
  bool touched = true;
  free_to_ = begin_;
  for (std::size_t i = nodes_.size() - 1; i-- > 0;) {
    const double y = reached(nodes_[i + 1], nodes_[i]);
    if (touched && y >= nodes_[i].y) {
      touched = false;
      free_to_ = nodes_[i].u;
    }
    nodes_[i].y = y;
  }
  double most = 0.0;
  for (const Node& node : nodes_) most = std::max(most, node.y);
  reached_ = v_of(most);
  time_.assign(nodes_.size(), 0.0);
  for (std::size_t i = 1; i < nodes_.size(); ++i)
    time_[i] = time_[i - 1] + time_over(nodes_[i - 1].y, nodes_[i].y, nodes_[i].u - nodes_[i - 1].u);
}

/// Places that are even in time.
void ClockEstimate::raw_steps(double end, bool last) {
  const double all = time_.back();
  std::size_t count = static_cast<std::size_t>(last ? std::ceil(all / step_) : std::floor(all / step_));
  if (past_count_ + count < kFewest) count = kFewest;
  const double step =
      last ? all / static_cast<double>(count) : std::min(step_, all / static_cast<double>(count));
  raw_.assign(1, begin_);
  std::size_t k = 0;
  for (std::size_t i = 1; i <= count; ++i) {
    const double t = std::min(all, static_cast<double>(i) * step);
    while (k + 2 < nodes_.size() && time_[k + 1] < t) ++k;
    const Node &from = nodes_[k], &to = nodes_[k + 1];
    const double h = to.u - from.u, rise = to.y - from.y;
    double share = 0.0;
    if (std::abs(rise) < 1e-6 * (from.y + to.y)) {
      share = (t - time_[k]) / std::max(1e-15, time_[k + 1] - time_[k]);
    } else {
      const double z = std::cbrt(from.y) + (t - time_[k]) * kTime * rise / (3.0 * h);
      share = (z * z * z - from.y) / rise;
    }
    raw_.push_back(from.u + std::clamp(share, 0.0, 1.0) * h);
  }
  if (last) raw_.back() = end;
}

/// Kinks of the clock would become jerk.
void ClockEstimate::smooth(bool last) {
  steps_ = past_;
  for (std::size_t i = 0; i + 1 < raw_.size(); ++i) steps_.push_back(raw_[i + 1] - raw_[i]);
  const std::size_t n = steps_.size(), before = past_count_ - past_.size();
  smooth_ = steps_;
  for (std::size_t i = 0; i < n; ++i) {
    if (before + i < kEdge || (last && i + kEdge >= n)) continue;
    const std::size_t from = i < kLeast ? 0 : i - kLeast, to = std::min(n, i + kLeast + 1);
    smooth_[i] = *std::min_element(steps_.begin() + static_cast<std::ptrdiff_t>(from),
                                   steps_.begin() + static_cast<std::ptrdiff_t>(to));
  }
  std::vector<double>& was = steps_;
  for (int pass = 0; pass < 3; ++pass) {
    was = smooth_;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t q = std::min({static_cast<std::size_t>(kMean), i, n - 1 - i});
      double sum = 0.0;
      for (std::size_t k = i - q; k <= i + q; ++k) sum += was[k];
      smooth_[i] = sum / static_cast<double>(2 * q + 1);
    }
  }
}

/// Takes what is decided; false, and nothing taken: fewer than so many steps.
bool ClockEstimate::commit(bool last, std::size_t fewest) {
  const std::size_t steps = raw_.size() - 1, past = past_.size();
  std::size_t count = steps;
  if (!last) {
    count = 0;
    while (count + 1 + kBeyond < steps && raw_[count + 1 + kBeyond] <= free_to_) ++count;
    if (count < fewest) {
      if (fewest > 1) return false;
      count = 1;
    }
  }
  old_cap_ = cap_;
  old_origin_ = origin_;
  old_spacing_ = spacing_;
  for (std::size_t i = 0; i < count; ++i) {
    field_.push_back({raw_[i], smooth_[past + i]});
    past_.push_back(raw_[i + 1] - raw_[i]);
  }
  past_count_ += count;
  if (past_.size() > kPast) past_.erase(past_.begin(), past_.end() - kPast);
  begin_ = raw_[count];
  std::size_t k = 0;
  while (k + 2 < nodes_.size() && nodes_[k + 1].u < begin_) ++k;
  const double share = (begin_ - nodes_[k].u) / (nodes_[k + 1].u - nodes_[k].u);
  begin_y_ = nodes_[k].y + std::clamp(share, 0.0, 1.0) * (nodes_[k + 1].y - nodes_[k].y);
  decided_ = last;
  return true;
}

/// Places one smooth step behind the other.
void ClockEstimate::integrate(const Run& run, Kept<double>& places) {
  fresh_.clear();
  const double length = run.length();
  for (;;) {
    while (field_at_ + 1 < field_.end() && field_[field_at_ + 1].u <= place_) ++field_at_;
    if (!decided_ && field_at_ + 1 >= field_.end()) break;
    if (decided_ && place_ >= length * (1.0 - 1e-12)) break;
    const Raw& from = field_[field_at_];
    double step = from.step;
    if (field_at_ + 1 < field_.end()) {
      const Raw& to = field_[field_at_ + 1];
      step += (place_ - from.u) / std::max(1e-15, to.u - from.u) * (to.step - from.step);
    }
    place_ += std::max(step, 1e-9);
    fresh_.push_back(place_);
  }
  field_.forget_before(field_at_);
  if (decided_) return stretch(length, places);
  for (const double u : fresh_) places.push_back(u);
}

/// The last places move a little, so that the last one is the end.
void ClockEstimate::stretch(double length, Kept<double>& places) {
  done_ = true;
  const bool whole = places.end() == 1;
  const double before = fresh_.size() < 2 ? places.back() : fresh_[fresh_.size() - 2];
  if (fresh_.size() > kFewest && fresh_.back() - length > length - before) fresh_.pop_back();
  const double n = static_cast<double>(fresh_.size()), off = length - fresh_.back(),
               scale = length / fresh_.back();
  for (std::size_t i = 0; i < fresh_.size(); ++i) {
    const double z = static_cast<double>(i + 1) / n;
    const double u = whole ? fresh_[i] * scale : fresh_[i] + off * z * z * (3.0 - 2.0 * z);
    places.push_back(std::min(i + 1 == fresh_.size() ? length : u, length));
  }
}

}  // namespace servogate::path
