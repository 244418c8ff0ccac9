// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

using Vector = ProfileVector;

constexpr int kMostPasses = 10'000;
constexpr double kEps = 1e-9, kDegree = std::numbers::pi / 180.0;
constexpr double kSteep = 0.01;        ///< a wall that leads less far along than this is one across
constexpr double kHardlyLeans = 0.17;  ///< 80 degrees from the direction of the work

Vector operator+(Vector a, Vector b) { return {a.along + b.along, a.out + b.out}; }
Vector operator-(Vector a, Vector b) { return {a.along - b.along, a.out - b.out}; }
Vector operator*(double s, Vector v) { return {s * v.along, s * v.out}; }
double cross(Vector a, Vector b) { return a.along * b.out - a.out * b.along; }
double dot(Vector a, Vector b) { return a.along * b.along + a.out * b.out; }
double length(Vector v) { return std::hypot(v.along, v.out); }

/// How much of the parts before and behind a point a corner takes.
struct Cut {
  double before = 0.0, behind = 0.0;
  bool any() const { return before > 0.0 || behind > 0.0; }
};

struct Piece {
  Vector to;
  bool arc = false;
  Vector centre;
  double sweep_deg = 0.0;  ///< + from along towards out
};

std::optional<Cut> chamfer(Vector before, Vector behind, Vector size) {
  const double turn = cross(before, behind);
  for (const double out : {-size.out, size.out})
    for (const double along : {size.along, -size.along}) {
      const Vector way{along, out};
      const Cut cut{cross(way, behind) / turn, cross(before, way) / turn};
      if (cut.before >= -kEps && cut.behind >= -kEps) return cut;
    }
  return std::nullopt;
}

/// The contour as it is in the end, and as the passes see it.
class Shape {
 public:
  explicit Shape(const Profile& profile) : profile_(profile) {
    points_.push_back({});
    for (const Vector& part : profile.parts) points_.push_back(points_.back() + part);
    for (std::size_t n = 0; n < points_.size(); ++n) cuts_.push_back(cut_at(n));
    for (std::size_t n = 0; n + 1 < points_.size(); ++n)
      if (cuts_[n].behind + cuts_[n + 1].before > length(profile.parts[n]) + kEps) refuse(n + 1);
    build();
  }
  const std::vector<Vector>& rough() const { return rough_; }
  Vector begin() const { return begin_; }
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// Direction of the part or surface before, and behind, a point.
  Vector before(std::size_t n) const { return n == 0 ? profile_.lead_in : direction(n - 1); }
  Vector behind(std::size_t n) const { return n == profile_.parts.size() ? profile_.lead_out : direction(n); }

 private:
  [[noreturn]] void refuse(std::size_t corner) const {
    fail(Fault::cycle_corner, 0, {profile_.name, std::to_string(corner)});
  }
  Vector direction(std::size_t part) const {
    return 1.0 / length(profile_.parts[part]) * profile_.parts[part];
  }
  Cut cut_at(std::size_t n) const {
    const ProfileCorner& corner = profile_.corners[n];
    const Vector one = before(n), other = behind(n);
    if (corner.kind == ProfileCorner::Kind::none || std::abs(cross(one, other)) < kEps) return {};
    if (corner.kind == ProfileCorner::Kind::chamfer) {
      if (corner.size.along <= 0.0 && corner.size.out <= 0.0) return {};
      if (const auto cut = chamfer(one, other, corner.size)) return *cut;
      refuse(n + 1);
    }
    const double taken = corner.radius * std::tan(std::acos(std::clamp(dot(one, other), -1.0, 1.0)) / 2.0);
    return {taken, taken};
  }
  void build() {
    begin_ = points_[0] - cuts_[0].before * before(0);
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const Vector from = points_[n] - cuts_[n].before * before(n),
                   to = points_[n] + cuts_[n].behind * behind(n);
      if (n > 0) pieces_.push_back({from, false, {}, 0.0});
      if (cuts_[n].any()) pieces_.push_back(corner(n, from, to));
      const bool inner = n > 0 && n + 1 < points_.size() && cross(before(n), behind(n)) > 0.0;
      if (inner && cuts_[n].any()) {
        rough_.push_back(from);
        rough_.push_back(to);
      } else {
        rough_.push_back(points_[n]);
      }
    }
  }
  Piece corner(std::size_t n, Vector from, Vector to) const {
    const ProfileCorner& c = profile_.corners[n];
    if (c.kind != ProfileCorner::Kind::round) return {to, false, {}, 0.0};
    const double side = cross(before(n), behind(n)) > 0.0 ? 1.0 : -1.0;
    const Vector normal{-side * before(n).out, side * before(n).along};
    const double turn = std::acos(std::clamp(dot(before(n), behind(n)), -1.0, 1.0)) / kDegree;
    return {to, true, from + c.radius * normal, side * turn};
  }

  const Profile& profile_;
  std::vector<Vector> points_, rough_;
  std::vector<Cut> cuts_;
  Vector begin_;
  std::vector<Piece> pieces_;
};

/// From where to where a pass at a level may cut.
struct Span {
  double from = 0.0, to = 0.0;
  bool open = false;  ///< no wall stands where it begins
};

std::optional<Span> span_at(const Profile& profile, const std::vector<Vector>& rough, double level) {
  const double deep = level - profile.allow_out;
  const auto above = [&](const Vector& point) { return point.out > deep + kEps; };
  const auto crossing = [&](Vector a, Vector b) {
    return a.along + (b.along - a.along) * (a.out - deep) / (a.out - b.out);
  };
  Span span;
  std::size_t first = 0, last = rough.size() - 1;
  while (first <= last && above(rough[first])) ++first;
  if (first > last) return std::nullopt;
  while (above(rough[last])) --last;
  span.open = first == 0;
  span.from = span.open ? rough[0].along : crossing(rough[first - 1], rough[first]) + profile.allow_along;
  span.to = last + 1 == rough.size() ? rough[last].along
                                     : crossing(rough[last + 1], rough[last]) - profile.allow_along;
  if (span.from > span.to + kEps) return std::nullopt;
  return span;
}

/// The tool, in the coordinates of the profile, with its feeds and speeds; those of before come back with it.
class Cutter {
 public:
  Cutter(Execution& run, const Profile& profile)
      : run_(run), profile_(profile), feed_(run.state().motion.feed), speed_(run.state().modes.speed) {
    set(profile.feed, profile.rpm);
  }
  void set(double feed, double rpm) {
    if (feed > 0.0) run_.state().motion.feed = feed;
    turn(rpm > 0.0 ? rpm : run_.state().modes.speed);
  }
  void restore() {
    run_.state().motion.feed = feed_;
    turn(speed_);
  }
  /// Where it stands along.
  double along() const {
    const double at = run_.state().frames.programmed[static_cast<std::size_t>(profile_.along)];
    return (at - profile_.begin_along) * profile_.forward;
  }
  void rapid(Vector to) { run_.motion().go(place(to), true); }
  void cut(Vector to) { run_.motion().go(place(to), false); }
  void cut(const Piece& piece) {
    if (!piece.arc) return cut(piece.to);
    const bool first = profile_.along == run_.state().frames.axis1;
    const double sense = profile_.forward * profile_.outward * (first ? 1.0 : -1.0);
    run_.motion().go_round(place(piece.to), place(piece.centre), sense * piece.sweep_deg);
  }

 private:
  Position place(Vector v) const {
    Position at = run_.state().frames.programmed;
    at[static_cast<std::size_t>(profile_.along)] = profile_.begin_along + profile_.forward * v.along;
    at[static_cast<std::size_t>(profile_.across)] = profile_.begin_across + profile_.outward * v.out;
    return at;
  }
  void turn(double rpm) {
    if (rpm == run_.state().modes.speed) return;
    run_.state().modes.speed = rpm;
    run_.motion().turn_spindle(run_.state().motion.spindle);
  }
  Execution& run_;
  const Profile& profile_;
  double feed_, speed_;
};

/// Passes, each entered from what the one before has freed.
class Passes {
 public:
  Passes(const Profile& profile, const Shape& shape, Cutter& cutter, double top)
      : profile_(profile),
        shape_(shape),
        cutter_(cutter),
        top_(top),
        free_(top + profile.approach),
        before_(top) {}

  void run() {
    double bottom = top_;
    for (const Vector& point : shape_.rough()) bottom = std::min(bottom, point.out);
    bottom += profile_.allow_out;
    const double count = std::ceil((top_ - bottom) / profile_.step - 1e-6);
    if (!(count <= kMostPasses)) fail(Fault::cycle_pecks, 0, {profile_.name, std::to_string(kMostPasses)});
    for (int pass = 1; pass <= static_cast<int>(count); ++pass) {
      const double level = pass == static_cast<int>(count) ? bottom : top_ - pass * profile_.step;
      const auto span = span_at(profile_, shape_.rough(), level);
      if (!span) break;  // it only becomes narrower
      enter(*span, level, pass == 1);
      cutter_.cut(Vector{span->to, level});
      cutter_.rapid({span->to, before_});
      free_ = std::exchange(before_, level);
      from_ = span->from;
      was_open_ = span->open;
      at_ = span->to;
    }
    cutter_.rapid({at_, top_ + profile_.approach});
  }

 private:
  void enter(const Span& span, double level, bool first) {
    if (span.open) {
      cutter_.rapid({span.from - profile_.approach, free_});
      cutter_.rapid({span.from - profile_.approach, level});
    } else if (profile_.square || was_open_) {
      cutter_.rapid({span.from, free_});
      cutter_.rapid({span.from, std::min(free_, before_ + profile_.approach)});
      cutter_.cut(Vector{span.from, level});
    } else if (first) {
      const Vector wall = shape_.behind(0), begin{span.from, level};
      // Along the wall from over everything, at least so far before it; a wall that hardly leans would lead
      // far away.
      const double over = (level - free_) / wall.out;
      const double way = wall.along < kSteep ? 0.0
                         : wall.along < kHardlyLeans
                             ? over - profile_.approach / wall.out
                             : std::max(profile_.approach / wall.along + level / wall.out, over);
      cutter_.rapid(wall.along < kSteep ? Vector{span.from, free_} : begin - way * wall);
      cutter_.cut(Vector{span.from, level});
    } else {
      cutter_.rapid({from_, free_});
      cutter_.cut(Vector{from_, before_});
      cutter_.cut(Vector{span.from, level});
    }
  }

  const Profile& profile_;
  const Shape& shape_;
  Cutter& cutter_;
  double top_;
  double free_;            ///< up from here nothing stands over what was cut
  double before_;          ///< level of the pass before
  double from_ = 0.0;      ///< where it began
  double at_ = 0.0;        ///< where it ended
  bool was_open_ = false;  ///< it began beside the material
};

}  // namespace

void turn_profile(Execution& run, const Profile& profile) {
  const Shape shape(profile);
  const Vector last = shape.rough().back();
  const double top = std::max(0.0, last.out);
  double clear = std::max(top, shape.begin().out);
  for (const Piece& piece : shape.pieces()) clear = std::max(clear, piece.to.out);
  clear += profile.approach;
  const bool open = last.out > kEps;  // it begins below its end: from the free side
  const Vector home{open ? -profile.approach : 0.0, clear};
  Cutter cutter(run, profile);
  cutter.rapid(home);
  if (profile.roughs) Passes(profile, shape, cutter, top).run();
  if (profile.finishes) {
    cutter.set(profile.last_feed, profile.last_rpm);
    const Vector above = open ? shape.begin() - profile.approach * profile.lead_in
                              : shape.begin() + Vector{0.0, profile.approach};
    cutter.rapid({cutter.along(), clear});
    cutter.rapid({above.along, clear});
    cutter.rapid(above);
    cutter.cut(shape.begin());
    for (const Piece& piece : shape.pieces()) cutter.cut(piece);
  }
  cutter.rapid({cutter.along(), clear});
  cutter.rapid(home);
  cutter.restore();
}

}  // namespace servogate::program
