// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/planner.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "kernel/path/law/course_planning.hpp"
#include "kernel/path/law/forecast.hpp"
#include "kernel/path/law/planning.hpp"
#include "kernel/path/shape/contour.hpp"
#include "kernel/path/shape/gather.hpp"
#include "kernel/path/track/publisher.hpp"

namespace servogate::path {
namespace {

/// An arc that needs so much of its axes at its feed that it is a good deal faster as a course.
bool needs_its_axes(const Leg& leg, double v, int axes) {
  constexpr double kAcceleration = 0.25, kJerk = 0.1;  // of the limits
  const Piece& p = leg.piece;
  if (p.shape != Piece::Shape::arc) return false;
  const double turning = v * std::abs(p.omega), a = p.radius * turning * turning;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    if (leg.axes != 0 ? !moves(leg, i) : i != p.axis1 && i != p.axis2) continue;
    const AxisLimits& limits = (*leg.limits)[i];
    if (a > kAcceleration * limits.acceleration || a * turning > kJerk * limits.jerk) return true;
  }
  return false;
}

/// The element from the place `s` of its parameter on, for a path that stands beside it.
std::vector<Element> rest_of(const Element& e, const Piece& piece, double s, int axes) {
  constexpr double kLittle = 1e-3;  // mm of an arc
  if (e.kind != Element::Kind::arc || piece.length - s < kLittle) {
    Element line = e;
    line.kind = Element::Kind::line;
    return {line};
  }
  Element back = e, arc = e;
  back.kind = Element::Kind::line;
  back.to = position(piece, s, axes);
  back.transition.confirm = false;
  arc.sweep_deg *= 1.0 - s / piece.length;
  return {back, arc};
}

}  // namespace

/// Shape, bound, law and track, one behind the other; two laws, chosen from rest to rest.
struct Planner::Impl final : ContourSink {
  Impl(const Config& c, Track& track, MomentSink* forecast)
      : config(c),
        publisher(track),
        law(c, track.pieces.capacity(), publisher),
        contour(c, *this),
        course(law_of_courses(c, forecast)),
        gather(c, *course) {}
  std::unique_ptr<CourseLaw> law_of_courses(const Config& c, MomentSink* forecast) {
    if (forecast != nullptr) return std::make_unique<CourseForecast>(c, *forecast, publisher);
    return std::make_unique<CoursePlanning>(c, publisher);
  }

  void put(const Piece& piece, const Pace& pace) override { law.append(piece, bound(config, piece, pace)); }
  void rest(bool confirm) override { law.rest(confirm); }

  void mark(Entry::Kind kind, std::uint32_t event, const Tag& tag) {
    Entry entry;
    entry.kind = kind;
    entry.event = event;
    entry.tag = tag;
    entry.tag.marks = marks;
    entry.at = at;
    entry.span.number = law.last_number();
    entry.span.first_piece = publisher.next().piece;
    publisher.put(entry);
  }

  /// What takes the elements since the last rest.
  enum class Run : std::uint8_t {
    none,
    undecided,  ///< there is one of them, which waits for another
    spans,      ///< the law from span to span
    course,     ///< the law over one clock
  };
  struct Waiting {
    Element element;
    Piece piece;
  };
  struct OnCourse {
    Waiting what;
    double begin;  ///< path parameter of the course
  };

  bool add(const Element& e);
  void finish();
  void forget() {
    end_run();
    waiting.clear();
    unasked_rest.reset();
  }
  void end_run() {
    run = Run::none;
    alone = 0;
    on_course.clear();
  }
  bool suits_course(const Element& e) const;
  bool same_feed(const Element& e) const;
  Run suitable() const;
  bool rests_before(const Element& e, const Piece& piece) const;
  void wait(const Element& e, const Piece& piece);
  void decide();
  void pass_on(const Element& e, const Piece& piece);
  void put_on_course(const Element& e, const Piece& piece);
  void begin_course(const Vector& from);
  void drive_alone(const std::vector<Element>& parts, std::deque<OnCourse>& behind);
  bool fall_back();

  Config config;
  Publisher publisher;
  Planning law;
  Contour contour;
  std::unique_ptr<CourseLaw> course;
  Gather gather;
  std::uint32_t marks = 0;
  Flaw flaw = Flaw::none;
  Vector at{};  ///< end of the elements added
  Run run = Run::none;
  bool rests = false;  ///< behind the elements of Run::spans
  std::vector<Waiting> waiting;
  Vector waiting_from{};
  std::deque<OnCourse> on_course;  ///< elements that the course may not come to the end of
  double course_length = 0.0;
  std::size_t alone = 0;  ///< elements driven alone behind the place where the course broke last
  Waiting before;         ///< the last element that moves
  std::optional<Tag> unasked_rest;
};

bool Planner::Impl::suits_course(const Element& e) const {
  return config.law != Law::spans && e.kind != Element::Kind::rapid && e.lock.kind == Lock::Kind::none;
}

/// A course is driven by the spindle as a whole, or not at all: it rests between one feed and the other.
bool Planner::Impl::same_feed(const Element& e) const {
  return (e.revolutions > 0.0) == (before.element.revolutions > 0.0);
}

/// The one place where the law is chosen: two elements and more are a course. A single one needs none, from
/// rest to rest along a line, and along an arc that needs little of its axes.
Planner::Impl::Run Planner::Impl::suitable() const {
  if (!std::all_of(waiting.begin(), waiting.end(), [&](const Waiting& w) { return suits_course(w.element); }))
    return Run::spans;
  if (waiting.size() > 1) return Run::course;
  const Waiting& single = waiting.front();
  if (single.piece.shape == Piece::Shape::line) return Run::spans;
  if (config.law == Law::course) return Run::course;
  Leg leg;
  leg.piece = single.piece;
  leg.limits = &config.limits;
  leg.axes = axes_moved(config, single.piece);
  leg.feed = single.element.feed;
  return needs_its_axes(leg, fastest(leg, config.axis_count), config.axis_count) ? Run::course : Run::spans;
}

bool Planner::Impl::rests_before(const Element& e, const Piece& piece) const {
  if (run == Run::course || run == Run::undecided) {
    if (run != Run::undecided && !(suits_course(e) && same_feed(e))) return true;
    return rests_between(config, before.element.transition, before.piece, e, piece);
  }
  return run == Run::spans && rests && suits_course(e) && goes_on(e);  // and may go over to a course
}

void Planner::Impl::wait(const Element& e, const Piece& piece) {
  if (waiting.empty()) waiting_from = at;
  waiting.push_back({e, piece});
  if (waiting.size() > 1) decide();
}

void Planner::Impl::decide() {
  run = suitable();
  if (run == Run::spans) {
    contour.restart(waiting_from);
    law.begin_at(publisher.next().piece, publisher.planned());
  } else {
    begin_course(waiting_from);
  }
  for (const Waiting& w : waiting) pass_on(w.element, w.piece);
  waiting.clear();
}

void Planner::Impl::begin_course(const Vector& from) {
  gather.restart(from);
  on_course.clear();
  course_length = 0.0;
}

void Planner::Impl::pass_on(const Element& e, const Piece& piece) {
  if (run == Run::spans) {
    contour.add(e);
    return;
  }
  put_on_course(e, piece);
  gather.add(e);
  if (gather.open()) return;
  while (fall_back()) {
  }
  end_run();
}

void Planner::Impl::put_on_course(const Element& e, const Piece& piece) {
  if (piece.length == 0.0 && goes_on(e)) return;  // it changes nothing
  on_course.push_back({{e, piece}, course_length});
  course_length += piece.length;
  while (on_course.size() > 1 && on_course[1].what.piece.length > 0.0 && on_course[1].begin <= course->sure())
    on_course.pop_front();
}

/// From rest to rest, exactly on the path; with what behind it moves nothing and decides how it ends.
void Planner::Impl::drive_alone(const std::vector<Element>& parts, std::deque<OnCourse>& behind) {
  for (const Element& part : parts) {
    contour.add(part);
    if (&part == &parts.back())
      for (; !behind.empty() && behind.front().what.piece.length == 0.0; behind.pop_front())
        contour.add(behind.front().what.element);
    contour.finish();
  }
}

/// No law was found for what comes next. Behind the place where the course rests some elements are driven
/// alone, and what is behind them is a course again; one that breaks where it begins has twice as many alone
/// before the next one. Gives whether there was such a place.
bool Planner::Impl::fall_back() {
  if (run != Run::course || !course->broken()) return false;
  const CourseLaw::Rest rest = course->rest_place();
  while (on_course.size() > 1 && on_course[1].what.piece.length > 0.0 && on_course[1].begin <= rest.place)
    on_course.pop_front();
  std::deque<OnCourse> left = std::exchange(on_course, {});
  const Waiting first = left.front().what;
  const double s = std::clamp(rest.place - left.front().begin, 0.0, first.piece.length);
  if (rest.x || alone == 0) unasked_rest = first.element.tag;
  alone = rest.x ? 1 : std::max<std::size_t>(1, 2 * alone);
  course->restart();
  contour.restart(rest.x ? *rest.x : path::position(first.piece, s, config.axis_count));
  law.begin_at(publisher.next().piece, publisher.planned());
  Vector from{};
  for (std::size_t n = 0; n < alone && !left.empty(); ++n) {
    const Element e = left.front().what.element;
    left.pop_front();
    drive_alone(n == 0 ? rest_of(e, first.piece, s, config.axis_count) : std::vector<Element>{e}, left);
    from = e.to;
  }
  begin_course(from);
  if (left.empty()) end_run();
  for (const OnCourse& next : left) {
    put_on_course(next.what.element, next.what.piece);
    gather.add(next.what.element);
  }
  return true;
}

bool Planner::Impl::add(const Element& e) {
  const Shaped shaped = shape(config, at, e);
  flaw = shaped.flaw;
  if (flaw != Flaw::none) return false;
  const bool moves = shaped.piece.length > 0.0;
  const bool locked = e.lock.kind != Lock::Kind::none;
  if (moves && locked != (before.element.lock.kind != Lock::Kind::none)) finish();
  if (moves && run == Run::undecided && !same_feed(e)) decide();
  if (moves && rests_before(e, shaped.piece)) finish();
  if (run == Run::none) run = Run::undecided;
  if (run != Run::undecided) {
    pass_on(e, shaped.piece);
  } else if (moves) {
    wait(e, shaped.piece);
    if (run == Run::undecided && !(suits_course(e) && goes_on(e))) decide();
  } else if (waiting.empty()) {
    run = Run::none;
  } else if (!goes_on(e)) {  // it only decides how the element before ends
    decide();
    pass_on(e, shaped.piece);
  }
  if (moves) rests = !goes_on(e);
  if (moves) before = {e, shaped.piece};
  at = e.to;
  return true;
}

void Planner::Impl::finish() {
  if (run == Run::undecided) decide();
  if (run == Run::spans) contour.finish();
  while (run == Run::course) {
    gather.finish();
    if (!fall_back()) break;
  }
  end_run();
}

Planner::Planner(const Config& config, Track& track, MomentSink* forecast)
    : impl_(std::make_unique<Impl>(config, track, forecast)) {}
Planner::~Planner() = default;

Track::Begin Planner::restart(const Vector& at) {
  Impl& p = *impl_;
  const Track::Begin begin = p.publisher.next();
  p.contour.restart(at);
  p.law.restart();
  p.course->restart();
  p.forget();
  p.at = at;
  p.mark(Entry::Kind::restart, 0, {});
  return begin;
}

bool Planner::add(const Element& element) {
  Element marked = element;
  marked.tag.marks = impl_->marks;
  return impl_->add(marked);
}

Flaw Planner::last_flaw() const { return impl_->flaw; }

std::optional<Tag> Planner::take_unasked_rest() { return std::exchange(impl_->unasked_rest, std::nullopt); }

void Planner::rest() { impl_->finish(); }

void Planner::add_mark() { ++impl_->marks; }

void Planner::add_event(std::uint32_t id, const Tag& tag) {
  impl_->finish();
  impl_->mark(Entry::Kind::event, id, tag);
}

void Planner::finish() {
  impl_->finish();
  impl_->mark(Entry::Kind::finish, 0, {});
}

bool Planner::wants_more() const { return impl_->publisher.wants_more(); }

bool Planner::waits() const { return impl_->publisher.waits(); }

double Planner::ahead(std::optional<double> driven) const { return impl_->publisher.ahead(driven); }

double Planner::planned() const { return impl_->publisher.planned(); }

void Planner::work() {
  impl_->course->work();
  impl_->fall_back();
  impl_->publisher.work();
}

const Vector& Planner::position() const { return impl_->at; }

}  // namespace servogate::path
