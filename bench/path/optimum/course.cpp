// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/course.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/path/planner.hpp"

namespace servogate::bench {
namespace {

constexpr double kSpacing = 0.05;    // mm
constexpr double kBlendPlaces = 12;  // along a blend or quintic

/// Collects pieces until the path rests.
class Maker {
 public:
  Maker(int axes, double feed) : axes_(axes), feed_(feed) {}

  void take(const path::Piece& piece) {
    pieces_.push_back({piece, length_});
    length_ += piece.length;
  }

  void rest(Shaped& out) {
    if (pieces_.empty()) return;
    Course course;
    std::size_t n = 0;
    for (const double s : positions()) {
      while (n + 1 < pieces_.size() && s > pieces_[n + 1].start) ++n;
      course.push_back(place(pieces_[n], s));
    }
    out.length += length_;
    out.courses.push_back(std::move(course));
    pieces_.clear();
    length_ = 0.0;
  }

 private:
  struct Laid {
    path::Piece piece;
    double start;
  };

  /// Inside of the pieces, as the third derivative jumps where they join.
  std::vector<double> positions() const {
    const double spacing = std::min(kSpacing, length_ / 200.0);
    const std::vector<double> ends = graded(2.2 * length_, spacing);
    std::vector<double> out;
    for (std::size_t k = 0; ends[k + 1] - ends[k] < 0.99 * spacing && ends[k] < 0.4 * length_; ++k)
      out.push_back(ends[k]);
    const double begin = out.back(), end = length_ - begin;
    const std::size_t count = out.size();
    for (const Laid& laid : pieces_) {
      const path::Piece& p = laid.piece;
      const double by_shape = p.shape == path::Piece::Shape::blend ? kBlendPlaces * p.length / p.full : 0.0;
      const int m = static_cast<int>(std::ceil(std::max(p.length / spacing, by_shape)));
      for (int k = 0; k < m; ++k) {
        const double s = laid.start + p.length * (k + 0.5) / m;
        if (s > begin * (1 + 1e-9) && s < end * (1 - 1e-9) && s > out.back() + 1e-7) out.push_back(s);
      }
    }
    for (std::size_t k = count; k-- > 0;) out.push_back(length_ - out[k]);
    return out;
  }

  Place place(const Laid& laid, double s) const {
    const path::PathPoint at =
        path::evaluate(laid.piece, std::clamp(s - laid.start, 0.0, laid.piece.length), axes_);
    Place p;
    p.s = s;
    double rate = 0.0;
    for (int i = 0; i < kCourseAxes; ++i) {
      p.d1[i] = at.d1[i];
      p.d2[i] = at.d2[i];
      p.d3[i] = at.d3[i];
      rate += at.d1[i] * at.d1[i];
    }
    p.cap = feed_ / std::sqrt(rate);
    return p;
  }

  int axes_;
  double feed_, length_ = 0.0;
  std::vector<Laid> pieces_;
};

/// An element as the program means it: a line, or an arc in the plane of two axes.
struct Leg {
  Leg(const Triple& begin, const path::Element& element) : from(begin), e(element) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kCourseAxes; ++k) {
      const bool in_plane = arc() && (k == e.axis1 || k == e.axis2);
      const double d = in_plane ? 0.0 : e.to[k] - from[k];
      sum += d * d;
    }
    if (arc()) sum += std::pow(radius() * sweep(), 2);
    length = std::sqrt(sum);
  }

  Triple at(double s) const {
    const double share = length > 0.0 ? s / length : 1.0;
    Triple x;
    for (std::size_t k = 0; k < kCourseAxes; ++k) x[k] = from[k] + share * (e.to[k] - from[k]);
    if (!arc()) return x;
    const double angle = std::atan2(from[e.axis2] - e.center2, from[e.axis1] - e.center1) + share * sweep();
    x[e.axis1] = e.center1 + radius() * std::cos(angle);
    x[e.axis2] = e.center2 + radius() * std::sin(angle);
    return x;
  }

  bool arc() const { return e.kind == path::Element::Kind::arc; }
  double sweep() const { return e.sweep_deg / 180.0 * std::numbers::pi; }
  double radius() const { return std::hypot(from[e.axis1] - e.center1, from[e.axis2] - e.center2); }

  Triple from;
  path::Element e;
  double length = 0.0;
};

}  // namespace

Shaped shape_of(const path::Config& config, const Program& program) {
  path::Config by_spans = config;
  by_spans.law = path::Law::spans;
  path::Track track(by_spans);
  path::Planner planner(by_spans, track);
  planner.restart({});
  Shaped out;
  Maker maker(config.axis_count, program.front().feed);
  // Whether a span ends in a stop is known for good when it is final.
  std::vector<path::Span> spans;
  std::vector<path::Piece> pieces;
  std::uint64_t entry = 0;
  const auto read = [&] {
    for (planner.work(); entry < track.entries.written(); planner.work()) {
      for (; entry < track.entries.written(); track.entries.free_below(++entry)) {
        const path::Entry& e = track.entries[entry];
        if (e.kind == path::Entry::Kind::span) spans.push_back(e.span);
        if (e.kind == path::Entry::Kind::revise)
          spans[e.span.number - spans.front().number].stop = e.span.stop;
      }
      for (std::uint64_t n = track.pieces.freed(); n < track.pieces.written(); ++n)
        pieces.push_back(track.pieces[n]);
      track.pieces.free_below(track.pieces.written());
    }
  };
  for (const path::Element& e : program) {
    planner.add(e);
    read();
  }
  planner.finish();
  read();
  for (const path::Span& span : spans) {
    for (std::uint64_t n = 0; n < span.pieces; ++n) maker.take(pieces[span.first_piece + n]);
    if (span.stop) maker.rest(out);
  }
  return out;
}

Line programmed(const Program& program, double step) {
  Triple from{};
  std::vector<Leg> legs;
  double length = 0.0;
  for (const path::Element& e : program) {
    legs.push_back(Leg(from, e));
    length += legs.back().length;
    for (std::size_t k = 0; k < kCourseAxes; ++k) from[k] = e.to[k];
  }
  const auto count = static_cast<std::size_t>(std::ceil(length / step));
  Line out;
  out.step = length / static_cast<double>(count);
  std::size_t n = 0;
  double before = 0.0;
  for (std::size_t i = 0; i <= count; ++i) {
    const double s = out.step * static_cast<double>(i);
    while (n + 1 < legs.size() && s > before + legs[n].length) before += legs[n++].length;
    out.points.push_back(legs[n].at(std::min(s - before, legs[n].length)));
  }
  return out;
}

Limits limits_of(const path::Config& config) {
  Limits out;
  for (int i = 0; i < kCourseAxes; ++i) {
    out.velocity[i] = config.limits[i].velocity;
    out.acceleration[i] = config.limits[i].acceleration;
    out.jerk[i] = config.limits[i].jerk;
  }
  return out;
}

}  // namespace servogate::bench
