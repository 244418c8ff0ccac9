// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/contour/contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace servogate::program {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSame = 1e-9;       ///< mm
constexpr double kSmooth = 1e-5;     ///< sine of a turn that is none
constexpr double kBackwards = 1e-6;  ///< mm or degrees that an element may be passed backwards by rounding
constexpr std::size_t kMostBehind = 256;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
Point plus(Point a, Point b, double factor) { return {a.x + factor * b.x, a.y + factor * b.y}; }
double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
double distance(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }
bool same(Point a, Point b) { return distance(a, b) < kSame; }

/// The element without its ends. The radius of an arc is the one at `by`.
Directed directed(const ContourElement& e, Point by) {
  if (!e.arc) return line_through(e.start, e.end);
  return circle_about(e.centre, std::copysign(distance(by, e.centre), e.sweep_deg));
}

Point direction(const ContourElement& e, Point where) { return direction_at(directed(e, where), where); }

/// Where the tool's centre stands at an end of an element.
Point beside(const ContourElement& e, Point where) {
  return plus(where, left_of(direction(e, where)), e.left);
}

/// Angle by which a point about a centre is ahead of another one, -180 to 180 degrees.
double ahead(Point centre, Point of, Point point) {
  const Point a = plus(of, centre, -1.0), b = plus(point, centre, -1.0);
  return std::atan2(cross(a, b), dot(a, b)) / kDegree;
}

/// Share of a way at which a point stands on an element; 0 is its start, 1 its end.
double share(const ContourElement& e, Point point) {
  if (!e.arc) {
    const Point way = plus(e.end, e.start, -1.0);
    return dot(plus(point, e.start, -1.0), way) / dot(way, way);
  }
  double angle = ahead(e.centre, e.start, point);
  if (angle * e.sweep_deg < -kBackwards) angle += std::copysign(360.0, e.sweep_deg);
  return angle / e.sweep_deg;
}

[[noreturn]] void fail_at(Fault fault, const Place& place, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(fault), place.column, std::move(arguments), place.line};
}

/// The tool's centre takes as long for its arc as the feed takes for the programmed one.
Feed scaled(const ContourElement& e, double radius, double across) {
  const double programmed = distance(e.start, e.centre);
  const bool inside = radius < programmed;
  if (e.feed_of == ArcFeed::tool_centre || e.left == 0.0 || e.feed.unit == FeedUnit::inverse_time ||
      (e.feed_of == ArcFeed::inside && !inside))
    return e.feed;
  const double turn = std::abs(e.sweep_deg) * kDegree;
  Feed feed = e.feed;
  feed.value *= std::hypot(radius * turn, across) / std::hypot(programmed * turn, across);
  return feed;
}

std::string millimetres(double value) { return text::number(value, 4); }

}  // namespace

bool Contour::corner_ahead() const {
  if (dialect_.corner_word == nullptr) return false;
  const Source& source = flow_.source();
  for (std::uint32_t line = flow_.line() + 1; line < source.lines(); ++line) {
    const std::string_view text = source.line(line);
    const std::size_t first = skip_spaces(text, 0);
    if (!holds_nothing(dialect_.lexis, text, first)) return dialect_.corner_word(text, first);
  }
  return false;
}

template <typename What>
void Contour::emit(const Place& place, What&& what) {
  put(Command{place.line, place.file, process_, place.block, std::forward<What>(what)});
}

/// What is watched keeps its order with all that stands between.
void Contour::put(Command command) {
  if (!watch_.on || state_.mode == ContourState::Mode::off) {
    end_watch();
    queue_.commands.push_back(std::move(command));
    return;
  }
  WatchedCommand kept;
  kept.command = std::move(command);
  state_.watched.push_back(std::move(kept));
}

void Contour::end_watch() {
  for (WatchedCommand& kept : std::exchange(state_.watched, {}))
    queue_.commands.push_back(std::move(kept.command));
}

Position Contour::position(const Position& programmed) const {
  if (state_.held) return state_.last;
  Position there = programmed;
  if (state_.shifted()) {
    there[at(at_.axis1)] += state_.shift.x;
    there[at(at_.axis2)] += state_.shift.y;
  }
  return there;
}

void Contour::begin(int side, double radius, int column) {
  frames_.need_plane(column);
  state_.mode = ContourState::Mode::entering;
  state_.left = side * radius * at_.frame.sense(at_.axis1, at_.axis2);
}

void Contour::hold(ContourElement element, Point from) {
  state_.held = std::move(element);
  state_.held_enters = false;
  state_.from = from;
}

void Contour::take(ContourElement e) {
  e.feed_of = arc_feed_;
  if (!state_.engaged()) state_.last = position(at_.machine);
  const bool flat = !e.arc && same(e.start, e.end);
  if (state_.mode == ContourState::Mode::entering && (e.in_plane || e.arc)) {
    if (e.arc) fail_at(Fault::contour_entry_arc, e.place);
    state_.mode = ContourState::Mode::on;
    hold(std::move(e), plus(e.start, state_.shift, 1.0));
    state_.held_enters = true;
    return;
  }
  e.left = state_.mode == ContourState::Mode::on ? state_.left : 0.0;
  e.compensated = state_.mode == ContourState::Mode::on;
  if (flat && (state_.engaged() || !e.in_plane)) {
    if (state_.behind.size() == kMostBehind)
      fail_at(Fault::contour_behind, e.place, {std::to_string(kMostBehind)});
    const Point where = plus(e.start, state_.shift, 1.0);
    state_.behind.emplace_back(std::move(e));
    if (!state_.held) release(where);
    return;
  }
  if (state_.held) {
    join(std::move(e));
  } else {
    const bool returns = state_.mode == ContourState::Mode::off && state_.shifted();
    if (returns && e.arc) fail_at(Fault::contour_exit_arc, e.place);
    const Point from = plus(e.start, state_.shift, 1.0);
    if (returns) state_.shift = {};
    hold(std::move(e), from);
  }
  if (state_.coming.kind != CornerWord::Kind::none) {
    state_.corner = std::exchange(state_.coming, CornerWord{});
    return;
  }
  if (state_.mode == ContourState::Mode::off && !corner_ahead()) flush();
}

void Contour::corner(CornerWord word) {
  if (!state_.held || state_.held_enters || state_.corner.kind != CornerWord::Kind::none)
    fail_at(Fault::corner_place, word.place);
  state_.corner = std::move(word);
}

void Contour::join(ContourElement next) {
  const ContourElement first = *state_.held;
  if (state_.held_enters) {
    Point entry = beside(next, next.start);
    if (state_.before) {
      state_.before->left = next.left;
      entry = joint(*state_.before, next, false).begin;
      state_.before.reset();
    }
    give(first, entry);
    release(entry);
    return hold(std::move(next), entry);
  }
  CornerWord word = std::exchange(state_.corner, CornerWord{});
  // A language whose corner stands in the block of its element gives no sense: it is that of the turn.
  if (dialect_.corner_word == nullptr && word.kind == CornerWord::Kind::radius &&
      cross(direction(first, first.end), direction(next, next.start)) < 0.0)
    word.value = -word.value;
  if (word.kind == CornerWord::Kind::none || word.kind == CornerWord::Kind::rolled)
    return pass(first, next, word.kind == CornerWord::Kind::rolled);
  ContourElement one = first;
  const ContourElement middle =
      word.kind == CornerWord::Kind::chamfer ? chamfer(one, next, word) : between(one, next, word);
  pass(one, middle, false);
  pass(middle, next, false);
}

/// The arc of a radius that joins two elements; both are shortened to it.
ContourElement Contour::between(ContourElement& first, ContourElement& second, const CornerWord& word) {
  const Point corner = first.end;
  const AtMostTwo<Joining> found =
      joining_circles(directed(first, corner), directed(second, corner), word.value);
  const Joining* best = nullptr;
  for (int i = 0; i < found.count; ++i) {
    const double one = share(first, found[i].first), two = share(second, found[i].second);
    if (!(one > -kBackwards && one < 1.0 + kBackwards && two > -kBackwards && two < 1.0 + kBackwards))
      continue;
    if (best == nullptr || distance(found[i].first, corner) < distance(best->first, corner)) best = &found[i];
  }
  if (best == nullptr) fail_at(Fault::corner_none, word.place, {millimetres(word.value)});
  ContourElement arc = first;
  arc.arc = true;
  arc.start = best->first;
  arc.end = best->second;
  arc.centre = best->circle.centre;
  arc.sweep_deg = best->sweep_deg;
  arc.place = word.place;
  first.sweep_deg *= share(first, arc.start);
  second.sweep_deg *= 1.0 - share(second, arc.end);
  first.end = arc.start;
  second.start = arc.end;
  return arc;
}

ContourElement Contour::chamfer(ContourElement& first, ContourElement& second, const CornerWord& word) {
  if (first.arc || second.arc) fail_at(Fault::chamfer_lines, word.place);
  for (const ContourElement* e : {&first, &second})
    if (distance(e->start, e->end) < word.value - kBackwards)
      fail_at(Fault::chamfer_long, word.place,
              {millimetres(word.value), millimetres(distance(e->start, e->end))});
  const Point corner = first.end;
  ContourElement line = first;
  line.start = plus(corner, direction(first, corner), -word.value);
  line.end = plus(corner, direction(second, corner), word.value);
  line.place = word.place;
  first.end = line.start;
  second.start = line.end;
  return line;
}

/// From the end of an element shifted to its side to the beginning of the next one.
Contour::Joint Contour::joint(const ContourElement& first, const ContourElement& second, bool rolled) const {
  const Point corner = first.end;
  const Point in = direction(first, corner), out = direction(second, second.start);
  const double sine = cross(in, out), cosine = dot(in, out);
  const double left = first.left;
  if (left == 0.0 && second.left == 0.0) return {corner, second.start};
  const Point end = beside(first, corner), begin = beside(second, second.start);
  if (std::abs(sine) < kSmooth && cosine > 0.0) return {end, begin};
  const bool back = std::abs(sine) < kSmooth;
  const bool outer = back || sine * left < 0.0;
  const auto roll = [&] {
    const double angle = back ? std::copysign(180.0, -left) : std::atan2(sine, cosine) / kDegree;
    return Joint{end, begin, true, angle};
  };
  if (outer && (rolled || back)) return roll();
  const AtMostTwo<Point> meeting = common_points(shifted(directed(first, corner), left),
                                                 shifted(directed(second, second.start), second.left));
  const Point* best = nullptr;
  for (int i = 0; i < meeting.count; ++i)
    if (best == nullptr || distance(meeting[i], corner) < distance(*best, corner))
      best = &meeting.items[at(i)];
  if (best != nullptr && (!outer || distance(*best, corner) <= dialect_.longest_spike * std::abs(left)))
    return {*best, *best};
  if (!outer) fail_at(Fault::contour_no_joint, second.place, {millimetres(std::abs(left))});
  return roll();
}

void Contour::pass(const ContourElement& first, const ContourElement& second, bool rolled) {
  const Joint joint = this->joint(first, second, rolled);
  give(first, joint.end);
  release(joint.end);
  if (joint.rolls) {
    ContourElement roll = first;
    roll.arc = true;
    roll.centre = first.end;
    roll.start = joint.end;
    roll.end = joint.begin;
    roll.sweep_deg = joint.roll_deg;
    roll.left = 0.0;
    state_.from = joint.end;
    give(roll, joint.begin);
  }
  hold(second, joint.begin);
}

namespace {

enum class On : std::uint8_t { no, end, inside };

On where(const WatchedCommand& way, Point place) {
  constexpr double kEnd = 1e-3;  // mm
  if (distance(place, way.from) < kEnd || distance(place, way.to) < kEnd) return On::end;
  if (way.sweep_deg == 0.0) {
    const Point all = plus(way.to, way.from, -1.0);
    const double share = dot(plus(place, way.from, -1.0), all) / dot(all, all);
    return share > 0.0 && share < 1.0 ? On::inside : On::no;
  }
  double angle = ahead(way.way.centre, way.from, place);
  if (angle * way.sweep_deg < 0.0) angle += std::copysign(360.0, way.sweep_deg);
  return std::abs(angle) < std::abs(way.sweep_deg) ? On::inside : On::no;
}

/// Ends that touch one another do not count: a closed contour has them.
bool cross_at(const WatchedCommand& one, const WatchedCommand& other, Point place) {
  const On a = where(one, place), b = where(other, place);
  return a != On::no && b != On::no && (a == On::inside || b == On::inside);
}

}  // namespace

/// The way of the tool's centre that has just been put must not cross one that is still kept back, the one
/// right before it apart: the tool would cut into the other side of a bottleneck.
void Contour::watch(const ContourElement& e, Point end, double sweep_deg) {
  if (state_.watched.empty() || !e.compensated || same(end, state_.from)) return;
  WatchedCommand& next = state_.watched.back();
  next.element = true;
  next.from = state_.from;
  next.to = end;
  next.sweep_deg = sweep_deg;
  next.way = sweep_deg == 0.0
                 ? line_through(next.from, end)
                 : circle_about(e.centre, std::copysign(distance(next.from, e.centre), sweep_deg));
  int count = 0;
  for (const WatchedCommand& way : state_.watched) count += way.element ? 1 : 0;
  int behind = count - 2;
  for (const WatchedCommand& way : state_.watched) {
    if (!way.element || behind-- <= 0) continue;
    const AtMostTwo<Point> meeting = common_points(way.way, next.way);
    for (int i = 0; i < meeting.count; ++i)
      if (cross_at(way, next, meeting[i]))
        fail_at(Fault::contour_bottleneck, e.place,
                {millimetres(std::abs(state_.left)), std::to_string(way.command.line)});
  }
  auto first = state_.watched.begin();
  for (; count > watch_.elements; ++first) {
    count -= first->element ? 1 : 0;
    queue_.commands.push_back(std::move(first->command));
  }
  state_.watched.erase(state_.watched.begin(), first);
}

void Contour::give(const ContourElement& element, Point end) {
  Position to = element.to;
  to[at(at_.axis1)] = end.x;
  to[at(at_.axis2)] = end.y;
  check(element, at_.axis1, end.x);
  check(element, at_.axis2, end.y);
  element.arc ? give_arc(element, end, to) : give_line(element, end, to);
  state_.last = to;
  state_.from = end;
}

void Contour::give_line(const ContourElement& e, Point end, const Position& to) {
  if (e.left != 0.0 && !same(e.start, e.end) &&
      dot(plus(end, state_.from, -1.0), direction(e, e.end)) < -kBackwards)
    fail_at(Fault::contour_reversed, e.place, {millimetres(std::abs(e.left))});
  if (same(end, state_.from) && to == state_.last) return;
  if (at_.zones_active) frames_.check_zones(state_.last, to, e.place.column);
  e.rapid ? emit(e.place, Rapid{to}) : emit(e.place, Line{to, e.feed, e.corner});
  watch(e, end, 0.0);
}

/// Way of the axes across the plane to `to`, mm.
double Contour::across(const Position& to) const {
  double sum = 0.0;
  for (int axis = 0; axis < machine_.real_axes(); ++axis)
    if (axis != at_.axis1 && axis != at_.axis2 && !machine_.rotary(axis))
      sum += std::pow(to[at(axis)] - state_.last[at(axis)], 2);
  return std::sqrt(sum);
}

void Contour::give_arc(const ContourElement& e, Point end, const Position& to) {
  const double sense = e.sweep_deg < 0.0 ? -1.0 : 1.0;
  const double radius = distance(e.start, e.centre) - sense * e.left;
  if (radius < kBackwards)
    fail_at(Fault::contour_inner_arc, e.place,
            {millimetres(std::abs(e.left)), millimetres(distance(e.start, e.centre))});
  double sweep = e.sweep_deg - ahead(e.centre, e.start, state_.from) + ahead(e.centre, e.end, end);
  if (sweep * sense < -kBackwards) fail_at(Fault::contour_reversed, e.place, {millimetres(std::abs(e.left))});
  if (std::abs(sweep) < kBackwards) sweep = 0.0;
  if (sweep == 0.0 && to == state_.last) return;
  if (sweep == 0.0) return emit(e.place, Line{to, e.feed, e.corner});
  const Box box = extent(state_.from, end, e.centre, sweep);
  for (const double x : {box.low.x, box.high.x}) check(e, at_.axis1, x);
  for (const double y : {box.low.y, box.high.y}) check(e, at_.axis2, y);
  Arc arc;
  arc.to = to;
  arc.axis1 = static_cast<std::uint8_t>(at_.axis1);
  arc.axis2 = static_cast<std::uint8_t>(at_.axis2);
  arc.center1 = e.centre.x;
  arc.center2 = e.centre.y;
  arc.sweep_deg = sweep;
  arc.feed = scaled(e, radius, across(to));
  arc.corner = e.corner;
  if (at_.zones_active) frames_.check_zones(state_.last, arc, e.place.column);
  emit(e.place, std::move(arc));
  watch(e, end, sweep);
}

void Contour::check(const ContourElement& element, int axis, double value) const {
  try {
    frames_.check_axis(axis, value, element.place.column);
  } catch (ProgramError& error) {
    error.line = element.place.line;
    throw;
  }
}

/// What stands between two elements, with the tool's centre at `where`.
void Contour::release(Point where) {
  for (auto& item : std::exchange(state_.behind, {})) {
    if (auto* command = std::get_if<Command>(&item)) {
      put(std::move(*command));
      continue;
    }
    const auto& e = std::get<ContourElement>(item);
    Position to = e.to;
    to[at(at_.axis1)] = where.x;
    to[at(at_.axis2)] = where.y;
    e.rapid ? emit(e.place, Rapid{to}) : emit(e.place, Line{to, e.feed, e.corner});
    state_.last = to;
  }
}

void Contour::follow(Command command) {
  if (state_.held)
    state_.behind.emplace_back(std::move(command));
  else
    put(std::move(command));
}

void Contour::flush() {
  if (!state_.held) return;
  if (state_.corner.kind != CornerWord::Kind::none) fail_at(Fault::corner_place, state_.corner.place);
  const ContourElement element = *state_.held;
  const bool alone = state_.held_enters || same(element.start, element.end);
  const Point end = alone ? element.end : beside(element, element.end);
  give(element, end);
  release(end);
  state_.shift = plus(end, element.end, -1.0);
  state_.held.reset();
  state_.held_enters = false;
}

void Contour::close(ContourElement first) {
  if (!state_.held || state_.held_enters) return flush();
  const ContourElement element = *state_.held;
  first.left = element.left;
  const Point end = joint(element, first, false).end;
  give(element, end);
  release(end);
  state_.shift = plus(end, element.end, -1.0);
  state_.held.reset();
}

void Contour::end() {
  flush();
  end_watch();
  state_.mode = ContourState::Mode::off;
  state_.before.reset();
}

void Contour::settle() {
  if (state_.engaged()) flush();
  end_watch();
  if (state_.shifted()) {
    at_.machine = position(at_.machine);
    frames_.changed();
  }
  drop();
}

void Contour::rescue(const ContourState& before) {
  state_ = before;
  state_.corner = CornerWord{};
  if (!state_.watched.empty()) {  // the bottleneck may begin there
    state_.watched.clear();
    state_.held.reset();
    state_.behind.clear();
    return;
  }
  try {
    flush();
  } catch (const ProgramError&) {
    state_.held.reset();
    state_.behind.clear();
  }
}

}  // namespace servogate::program
