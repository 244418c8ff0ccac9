// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/roughing.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"

namespace servogate::program {
namespace {

constexpr int kMostPasses = 10'000;
constexpr double kEps = 1e-6, kChordDeg = 0.25;

Point plus(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }

/// The contour as short chords, for where a pass ends. `swap`: along and across are exchanged.
std::vector<Point> chords(const Roughing& work) {
  std::vector<Point> out;
  Point from = work.start;
  for (std::size_t i = 0; i < work.contour.size(); ++i) {
    const TurnedElement& e = work.contour[i];
    const int parts = e.arc ? std::max(1, static_cast<int>(std::ceil(std::abs(e.sweep_deg) / kChordDeg))) : 1;
    for (int n = 1; n < parts; ++n) {
      const double angle = e.sweep_deg * n / parts, x = from.x - e.centre.x, y = from.y - e.centre.y;
      out.push_back({e.centre.x + x * cos_deg(angle) - y * sin_deg(angle),
                     e.centre.y + x * sin_deg(angle) + y * cos_deg(angle)});
    }
    out.push_back(e.end);
    from = e.end;
  }
  for (Point& p : out) {
    p = plus(p, work.allowance);
    if (!work.along_first) std::swap(p.x, p.y);
  }
  return out;
}

/// Of the depths: the side on which the tool works.
double middle(const std::vector<Point>& points) {
  double sum = 0.0;
  for (const Point& p : points) sum += p.y;
  return sum / static_cast<double>(points.size());
}

/// From where to where a pass at a level is free of the contour.
struct Span {
  double from, to;
};

class Passes {
 public:
  Passes(Execution& run, const Roughing& work)
      : run_(run), work_(work), points_(chords(work)), start_(turned(work.start)) {
    forward_ = points_.back().x < points_.front().x ? -1.0 : 1.0;
    double deepest = points_.front().y;
    in_ = middle(points_) < start_.y ? -1.0 : 1.0;
    for (const Point& p : points_) deepest = in_ < 0.0 ? std::min(deepest, p.y) : std::max(deepest, p.y);
    bottom_ = deepest;
    const Point allowed = turned(work.allowance);
    top_ = start_.y + allowed.y;
  }

  void run() {
    const double way = (bottom_ - top_) * in_;
    const double count = std::ceil(way / work_.depth - 1e-6);
    if (!(count <= kMostPasses)) fail(Fault::cycle_pecks, 0, {work_.name, std::to_string(kMostPasses)});
    double before = start_.y;
    for (int n = 1; n <= static_cast<int>(count); ++n) {
      const double level = n == static_cast<int>(count) ? bottom_ : top_ + in_ * n * work_.depth;
      if ((level - start_.y) * in_ <= kEps) continue;
      const std::vector<Span> spans = spans_at(level);
      for (std::size_t i = 0; i < spans.size(); ++i) pass(spans[i], level, before, i == 0 && open(level));
      before = level;
    }
  }

 private:
  Point turned(Point p) const { return work_.along_first ? p : Point{p.y, p.x}; }
  bool below(const Point& p, double level) const { return (p.y - level) * in_ > -kEps; }
  /// The pass begins beside the material, where the tool stood.
  bool open(double level) const { return below(points_.front(), level); }

  std::vector<Span> spans_at(double level) const {
    std::vector<Span> spans;
    bool inside = open(level);
    double from = inside ? start_.x : 0.0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const Point &a = points_[i - 1], &b = points_[i];
      const bool here = below(b, level);
      if (here == inside) continue;
      const double share = a.y == b.y ? 0.0 : (level - a.y) / (b.y - a.y);
      const double at = a.x + (b.x - a.x) * std::clamp(share, 0.0, 1.0);
      if (inside)
        spans.push_back({from, at});
      else
        from = at;
      inside = here;
    }
    if (inside) spans.push_back({from, points_.back().x});
    std::erase_if(spans, [this](const Span& s) { return (s.to - s.from) * forward_ <= kEps; });
    return spans;
  }

  void go(double along, double across, bool rapid) {
    const Point to = turned({along, across});
    Position at = run_.state().frames.programmed;
    at[static_cast<std::size_t>(run_.state().frames.axis1)] = to.x;
    at[static_cast<std::size_t>(run_.state().frames.axis2)] = to.y;
    run_.motion().go(at, rapid);
  }
  Point stands() const {
    const FramesState& frames = run_.state().frames;
    return turned({frames.programmed[static_cast<std::size_t>(frames.axis1)],
                   frames.programmed[static_cast<std::size_t>(frames.axis2)]});
  }

  void pass(const Span& span, double level, double before, bool beside) {
    const double clear = before - in_ * work_.retract;
    const double safe = (clear - start_.y) * in_ < 0.0 ? start_.y : clear;
    if (!beside) {
      go(stands().x, safe, true);
      go(span.from, safe, true);
      go(span.from, level, false);
    } else {
      go(span.from, level, true);
    }
    go(span.to, level, false);
    const double away = level - in_ * work_.retract;
    const double out = (away - start_.y) * in_ < 0.0 ? start_.y : away;
    const double back = span.to - forward_ * std::min(work_.retract, std::abs(span.to - span.from));
    go(back, out, true);
    go(beside ? start_.x : span.from, out, true);
  }

  Execution& run_;
  const Roughing& work_;
  std::vector<Point> points_;
  Point start_;
  double forward_ = -1.0, in_ = -1.0, bottom_ = 0.0, top_ = 0.0;
};

}  // namespace

RoughingFault check_roughing(const Roughing& work) {
  const std::vector<Point> points = chords(work);
  const double forward = points.back().x < points.front().x ? -1.0 : 1.0;
  const double out = points.back().y < points.front().y ? -1.0 : 1.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const bool along = (points[i].x - points[i - 1].x) * forward < -kEps;
    const bool across = !work.pockets && (points[i].y - points[i - 1].y) * out < -kEps;
    if (along || across) return {true, along == work.along_first ? 0 : 1};
  }
  return {};
}

StartInside check_start(const Roughing& work) {
  Roughing bare = work;
  bare.allowance = {};
  const std::vector<Point> points = chords(bare);
  const double start = work.along_first ? work.start.y : work.start.x;
  const bool above = middle(points) < start;
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](Point a, Point b) { return a.y < b.y; });
  const double reach = above ? high->y : low->y;
  const bool inside = above ? start < reach - kEps : start > reach + kEps;
  return {inside, work.along_first ? 1 : 0, reach};
}

void follow_contour(Execution& run, const std::vector<TurnedElement>& contour, Point shift) {
  const auto a1 = static_cast<std::size_t>(run.state().frames.axis1);
  const auto a2 = static_cast<std::size_t>(run.state().frames.axis2);
  for (const TurnedElement& e : contour) {
    Position to = run.state().frames.programmed;
    to[a1] = e.end.x + shift.x;
    to[a2] = e.end.y + shift.y;
    if (!e.arc) {
      run.motion().go(to, e.rapid);
      continue;
    }
    Position centre = to;
    centre[a1] = e.centre.x + shift.x;
    centre[a2] = e.centre.y + shift.y;
    run.motion().go_round(to, centre, e.sweep_deg);
  }
}

void rough_contour(Execution& run, const Roughing& work) {
  Passes(run, work).run();
  const auto a1 = static_cast<std::size_t>(run.state().frames.axis1);
  const auto a2 = static_cast<std::size_t>(run.state().frames.axis2);
  const auto back = [&](bool along) {
    const bool first = along == work.along_first;
    Position to = run.state().frames.programmed;
    to[first ? a1 : a2] = first ? work.start.x : work.start.y;
    run.motion().go(to, true);
  };
  back(true);
  follow_contour(run, work.contour, work.allowance);
  back(false);
  back(true);
}

}  // namespace servogate::program
