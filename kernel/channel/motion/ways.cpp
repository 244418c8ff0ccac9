// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/ways.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace servogate::channel {

namespace {

constexpr double kShortest = 1e-9;  // mm or degrees
constexpr double kNear = 0.1;       // mm: a place that belongs to an element is no further from it
constexpr std::uint32_t kEnd = 1;   // the event at the end of a way
// A tag counts the parts of a way; from where it stands to the path, and from the path to where it ends, are
// no part of it.
constexpr std::uint64_t kKinds = 3, kToBegin = 1, kFromEnd = 2;

double distance(const path::Vector& p, const path::Vector& q) {
  double square = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) square += (p[i] - q[i]) * (p[i] - q[i]);
  return std::sqrt(square);
}

/// The place of a piece that is nearest to x, near s.
double foot(const path::Piece& piece, const path::Vector& x, double s, int axes) {
  constexpr int kSteps = 4;
  for (int n = 0; n < kSteps; ++n) {
    const path::PathPoint p = path::evaluate(piece, s, axes);
    double along = 0.0, square = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
      along += (x[i] - p.x[i]) * p.d1[i];
      square += p.d1[i] * p.d1[i];
    }
    s = std::clamp(s + along / square, 0.0, piece.length);
  }
  return s;
}

}  // namespace

Ways::Ways(const path::Config& config, WayLink& link)
    : config_(WayLink::small(config)), link_(link), planner_(config_, link.track) {}

void Ways::restart() {
  first_ += driven_.size();
  driven_.clear();
  parts_.clear();
  barred_ = known_ = false;
}

void Ways::add(const path::Element& element, const path::Vector& from) {
  Driven d{element, from, 0.0, barred_};
  d.length = piece(d).length;
  if (!(d.length > 0.0)) return;
  barred_ = false;
  driven_.push_back(d);
  if (driven_.size() <= kKept) return;
  driven_.pop_front();
  ++first_;
}

/// Where the path of the program stands. A block may have many elements: the first that is so near.
std::optional<Ways::Place> Ways::find(const path::Tag& tag, double to_go, const path::Vector& at) const {
  std::optional<Place> found;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < driven_.size() && least > kNear; ++n) {
    const Driven& d = driven_[n];
    if (d.element.tag.command != tag.command || d.element.tag.line != tag.line) continue;
    const path::Piece shape = piece(d);
    const double s = foot(shape, at, std::clamp(d.length - to_go, 0.0, d.length), config_.axis_count);
    const double off = distance(at, path::position(shape, s, config_.axis_count));
    if (off >= least) continue;
    least = off;
    found = Place{first_ + n, s};
  }
  return found;
}

/// Where a way was left; nullopt: that is not near it.
std::optional<Ways::Place> Ways::on_way(const path::Tag& tag, double to_go, const path::Vector& at) const {
  if (parts_.empty()) return here_;
  const Part& part = parts_[std::min<std::size_t>(tag.command / kKinds, parts_.size() - 1)];
  double s = part.end > part.begin ? part.end - to_go : part.end + to_go;
  if (tag.command % kKinds == kToBegin) s = part.begin;
  if (tag.command % kKinds == kFromEnd) s = part.end;
  const path::Piece shape = piece(driven(part.element));
  s = std::clamp(foot(shape, at, std::clamp(s, 0.0, shape.length), config_.axis_count),
                 std::min(part.begin, part.end), std::max(part.begin, part.end));
  if (distance(at, path::position(shape, s, config_.axis_count)) > kNear) return std::nullopt;
  return Place{part.element, s};
}

Ways::Place Ways::back(double distance, std::uint32_t blocks) {
  double left = blocks > 0 ? std::numeric_limits<double>::infinity() : distance;
  std::uint32_t passed = 0;
  bool moved = false;
  for (Place p = here_;;) {
    const Driven& d = driven(p.element);
    const double to = std::max(0.0, p.s - left);
    if (p.s - to > kShortest) {
      parts_.push_back({p.element, p.s, to});
      moved = true;
    }
    left -= p.s - to;
    p.s = to;
    if (to > 0.0 || left <= 0.0 || d.barred || p.element == first_) return p;
    const Driven& before = driven(p.element - 1);
    if (before.element.tag.command != d.element.tag.command) {
      if (moved && ++passed == blocks) return p;
      moved = false;
    }
    p = {p.element - 1, before.length};
  }
}

Ways::Place Ways::forward() {
  for (Place p = here_; p.element < home_.element; p = {p.element + 1, 0.0})
    if (driven(p.element).length - p.s > kShortest)
      parts_.push_back({p.element, p.s, driven(p.element).length});
  const double from = here_.element == home_.element ? here_.s : 0.0;
  parts_.push_back({home_.element, from, home_.s});
  return home_;
}

double Ways::behind_home(const Place& place) const {
  double sum = home_.s - place.s;
  for (std::uint64_t n = place.element; n < home_.element; ++n) sum += driven(n).length;
  return std::max(0.0, sum);
}

/// The set-points of the program are not on its path, and a way begins and ends there.
void Ways::join(const path::Element& like, const path::Vector& to, std::uint64_t tag) {
  path::Element e = like;
  if (distance(planner_.position(), to) <= kShortest) return;
  if (e.kind != path::Element::Kind::rapid) e.kind = path::Element::Kind::line;
  e.to = to;
  e.transition.continuation = path::Continuation::exact_stop;
  e.transition.confirm = false;
  e.tag.command = tag;
  planner_.add(e);
}

void Ways::put(const Part& part, bool last, const path::Vector& at, double feed) {
  const Driven& d = driven(part.element);
  const bool is_back = part.end < part.begin;
  const path::Piece shape = piece(d);
  const std::uint64_t number = kKinds * static_cast<std::uint64_t>(&part - parts_.data());
  path::Element e = d.element;
  if (feed > 0.0) {
    e.feed = e.kind == path::Element::Kind::rapid ? feed : std::min(e.feed, feed);
    if (e.kind == path::Element::Kind::rapid) e.kind = path::Element::Kind::line;
    e.revolutions = 0.0;  // a spindle that turns faster would drive it faster
    e.surface = {};
  }
  e.surface.late = 0.0;  // the spindle has had its time
  if (number == 0) join(e, path::position(shape, part.begin, config_.axis_count), number + kToBegin);
  if (is_back && part.end <= 0.0 && part.element > first_)
    e.transition = driven(part.element - 1).element.transition;
  e.transition.confirm = false;
  if (last) e.transition.continuation = path::Continuation::exact_stop;
  e.to = path::position(shape, part.end, config_.axis_count);
  e.sweep_deg *= (part.end - part.begin) / d.length;
  e.tag.command = number;
  if (std::abs(part.end - part.begin) > kShortest) planner_.add(e);
  if (last) join(e, at, number + kFromEnd);
}

void Ways::plan(const WayOrder& order, const path::Vector& at) {
  if (!order.on_way) {
    const std::optional<Place> found = find(order.tag, order.to_go, at);
    known_ = found.has_value();
    here_ = home_ = found.value_or(Place{});
    home_at_ = at;
  } else if (known_) {
    const std::optional<Place> found = on_way(order.tag, order.to_go, at);
    known_ = found.has_value();
    here_ = found.value_or(here_);
  }
  parts_.clear();
  WayLink::Begin begin;
  begin.track = planner_.restart(at);
  begin.home = !order.on_way;
  if (known_) {
    const Place end = order.forward ? forward() : back(order.distance, order.blocks);
    const Driven& d = driven(end.element);
    const path::Vector to = order.forward ? home_at_ : path::position(piece(d), end.s, config_.axis_count);
    begin.from = behind_home(here_);
    begin.to = behind_home(end);
    begin.home = order.forward || (parts_.empty() && !order.on_way);
    for (const Part& part : parts_) put(part, &part == &parts_.back(), to, order.feed);
  }
  planner_.add_event(kEnd, {});
  link_.begin(order.number, begin);
  planner_.work();
}

}  // namespace servogate::channel
