// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/planner.hpp"

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "kernel/path/law/course_planning.hpp"
#include "kernel/path/law/forecast.hpp"
#include "kernel/path/law/planning.hpp"
#include "kernel/path/shape/gather.hpp"
#include "kernel/path/shape/thread_chain.hpp"
#include "kernel/path/track/publisher.hpp"

namespace servogate::path {
namespace {

/// An arc that needs so much of its axes at its feed that it is a good deal faster as a course.
bool needs_its_axes(const Leg& leg, double v, int axes) {
  constexpr double kAcceleration = 0.25, kJerk = 0.1;  // of the limits
  const Piece& p = leg.piece;
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
  arc.sweep_deg *= 1.0 - s / piece.length;
  return {back, arc};
}

/// An exact stop that asks the follower to wait.
bool confirms(const Element& e) {
  return e.transition.confirm && e.transition.continuation == Continuation::exact_stop;
}

/// `behind` moves nothing and decides how the element ends.
void stop_behind(Element& e, const Element& behind) {
  e.transition.confirm = confirms(e) || confirms(behind);
  e.transition.continuation = Continuation::exact_stop;
}

bool suits_course(const Element& e) {
  return e.kind != Element::Kind::rapid && e.lock.kind == Lock::Kind::none;
}

}  // namespace

/// Shape, bound, law and track, one behind the other; the law is chosen from rest to rest.
struct Planner::Impl final : ChainSink {
  Impl(const Config& c, Track& track, MomentSink* forecast)
      : config(c),
        publisher(track),
        law(c, track.pieces.capacity(), publisher),
        chain(c, *this),
        course(law_of_courses(c, forecast)),
        gather(c, *course) {}
  std::unique_ptr<CourseLaw> law_of_courses(const Config& c, MomentSink* forecast) {
    if (forecast != nullptr) return std::make_unique<CourseForecast>(c, *forecast, publisher);
    return std::make_unique<CoursePlanning>(c, publisher);
  }

  void put(const Piece& piece, const Element& element) override {
    law.append(piece, bound(config, piece, element));
  }
  void rest() override { law.rest(false); }

  void mark(Entry::Kind kind, std::uint32_t event, const Tag& tag) {
    Entry entry;
    entry.kind = kind;
    entry.event = event;
    entry.tag = tag;
    entry.at = at;
    entry.span.first_piece = publisher.next().piece;
    publisher.put(entry);
  }

  /// What takes the elements since the last rest.
  enum class Run : std::uint8_t {
    none,
    threads,  ///< the chain of threads
    course,   ///< the law over one clock
  };
  struct Laid {
    Element element;
    Piece piece;
  };
  struct OnCourse {
    Laid what;
    double begin;  ///< path parameter of the course
  };

  /// Does it now, or behind a rest that is not planned yet.
  template <class What>
  void in_turn(const What& what) {
    if (ends)
      behind.push_back(what);
    else
      what();
  }
  void mark_at_rest(Entry::Kind kind, std::uint32_t event, Tag tag);
  bool plan();
  void close_course();
  void add(const Element& e, const Piece& piece);
  bool take(const Element& e, const Piece& piece);
  void rest_behind(const Element& e, const Piece& piece);
  void finish();
  void forget() {
    end_run();
    ends = false;
    behind.clear();
    single.reset();
    unasked_rest.reset();
  }
  void end_run() {
    run = Run::none;
    alone = 0;
    on_course.clear();
  }
  bool passes_into(const Laid& before, const Element& e, const Piece& piece) const;
  void drive(const Laid& what);
  void drive_alone(const Element& e, const Piece& piece, bool confirm);
  Vector drive_rest(Vector from, const std::vector<Element>& parts, bool confirm);
  void begin_course(const Vector& from);
  void put_on_course(const Element& e, const Piece& piece);
  void pass_on(const Element& e, const Piece& piece);
  bool fall_back();

  Config config;
  Publisher publisher;
  Planning law;
  ThreadChain chain;
  std::unique_ptr<CourseLaw> course;
  Gather gather;
  std::uint32_t marks = 0;
  Flaw flaw = Flaw::none;
  Vector added{};                            ///< end of the elements added
  Vector at{};                               ///< the same of those that wait for nothing
  bool ends = false;                         ///< Run::course has got its rest, and is not planned to it
  std::deque<std::function<void()>> behind;  ///< it
  Run run = Run::none;
  std::optional<Laid> single;      ///< behind a rest; a course, if another one follows without a rest
  std::deque<OnCourse> on_course;  ///< elements that the course may not come to the end of
  double course_length = 0.0;
  std::size_t alone = 0;  ///< elements driven alone behind the place where the course broke last
  std::optional<Tag> unasked_rest;
};

/// No rest lies between the two; a course is driven by the spindle as a whole, or not at all.
bool Planner::Impl::passes_into(const Laid& before, const Element& e, const Piece& piece) const {
  return suits_course(before.element) && suits_course(e) && goes_on(before.element) &&
         (e.revolutions > 0.0) == (before.element.revolutions > 0.0) &&
         !rests_between(config, before.element.transition, before.piece, e, piece);
}

void Planner::Impl::drive_alone(const Element& e, const Piece& piece, bool confirm) {
  law.begin_at(publisher.next().piece, publisher.planned());
  law.append(piece, bound(config, piece, e));
  law.rest(confirm);
}

/// From rest to rest a line needs no course, nor an arc that needs little of its axes.
void Planner::Impl::drive(const Laid& what) {
  const auto& [e, piece] = what;
  if (piece.shape == Piece::Shape::line) return drive_alone(e, piece, confirms(e));
  Leg leg;
  leg.piece = piece;
  leg.limits = &config.limits;
  leg.axes = axes_moved(config, piece);
  leg.feed = e.feed;
  if (!needs_its_axes(leg, fastest(leg, config.axis_count), config.axis_count))
    return drive_alone(e, piece, confirms(e));
  begin_course(path::position(piece, 0.0, config.axis_count));
  pass_on(e, piece);
}

void Planner::Impl::begin_course(const Vector& from) {
  run = Run::course;
  gather.restart(from);
  on_course.clear();
  course_length = 0.0;
}

void Planner::Impl::put_on_course(const Element& e, const Piece& piece) {
  if (piece.length == 0.0) {
    if (!goes_on(e)) stop_behind(on_course.back().what.element, e);
    return;
  }
  on_course.push_back({{e, piece}, course_length});
  course_length += piece.length;
  while (on_course.size() > 1 && on_course[1].begin <= course->sure()) on_course.pop_front();
}

void Planner::Impl::pass_on(const Element& e, const Piece& piece) {
  put_on_course(e, piece);
  gather.add(e);
  if (!gather.open()) close_course();
}

/// The run has got its rest.
void Planner::Impl::close_course() {
  for (;;) {
    ends = course->ends();
    if (ends) return;
    if (!fall_back()) break;
    if (run == Run::course) gather.finish();
  }
  end_run();
  if (single) finish();
}

/// What is left of an element, exactly on its path; gives where it ends.
Vector Planner::Impl::drive_rest(Vector from, const std::vector<Element>& parts, bool confirm) {
  for (const Element& part : parts) {
    const Piece piece = shape(config, from, part).piece;
    if (piece.length > 0.0) drive_alone(part, piece, confirm && &part == &parts.back());
    from = part.to;
  }
  return from;
}

/// No law was found for what comes next. Behind the place where the course rests some elements are driven
/// alone, and what is behind them is a course again; one that breaks where it begins has twice as many alone
/// before the next one. Gives whether there was such a place.
bool Planner::Impl::fall_back() {
  if (run != Run::course || !course->broken()) return false;
  const CourseLaw::Rest rest = course->rest_place();
  while (on_course.size() > 1 && on_course[1].begin <= rest.place) on_course.pop_front();
  std::deque<OnCourse> left = std::exchange(on_course, {});
  const Laid first = left.front().what;
  const double s = std::clamp(rest.place - left.front().begin, 0.0, first.piece.length);
  if (rest.x || alone == 0) unasked_rest = first.element.tag;
  alone = rest.x ? 1 : std::max<std::size_t>(1, 2 * alone);
  course->restart();
  Vector from = rest.x ? *rest.x : path::position(first.piece, s, config.axis_count);
  for (std::size_t n = 0; n < alone && !left.empty(); ++n) {
    const Element e = left.front().what.element;
    left.pop_front();
    from = drive_rest(from, n == 0 ? rest_of(e, first.piece, s, config.axis_count) : std::vector<Element>{e},
                      confirms(e));
  }
  if (left.size() < 2) {
    if (!left.empty()) single = left.front().what;
    end_run();
    return true;
  }
  begin_course(from);
  for (const OnCourse& next : left) {
    put_on_course(next.what.element, next.what.piece);
    gather.add(next.what.element);
  }
  return true;
}

void Planner::Impl::add(const Element& e, const Piece& piece) {
  if (piece.length > 0.0) {
    if (!take(e, piece)) return behind.push_front([this, e, piece] { add(e, piece); });
  } else if (!goes_on(e)) {
    rest_behind(e, piece);
  }
  at = e.to;
}

/// The one place where the law is chosen: two elements and more are a course. False: it needs a rest before
/// it that is not planned yet.
bool Planner::Impl::take(const Element& e, const Piece& piece) {
  if (run == Run::course && passes_into(on_course.back().what, e, piece)) {
    pass_on(e, piece);
    return true;
  }
  if (single && passes_into(*single, e, piece)) {
    const Laid before = *std::exchange(single, std::nullopt);
    begin_course(path::position(before.piece, 0.0, config.axis_count));
    pass_on(before.element, before.piece);
    pass_on(e, piece);
    return true;
  }
  const bool thread = e.lock.kind == Lock::Kind::thread;
  if (!thread || run != Run::threads) finish();
  if (ends) return false;
  if (e.lock.kind > Lock::Kind::thread) {
    drive_alone(e, piece, false);
  } else if (!thread) {
    single = {e, piece};
  } else {
    if (run != Run::threads) {
      run = Run::threads;
      chain.restart(at);
      law.begin_at(publisher.next().piece, publisher.planned());
    }
    chain.add(e);
  }
  return true;
}

/// The element moves nothing and decides how the one before ends.
void Planner::Impl::rest_behind(const Element& e, const Piece& piece) {
  if (single) {
    stop_behind(single->element, e);
  } else if (run == Run::course) {
    pass_on(e, piece);
  } else {
    finish();
  }
}

void Planner::Impl::finish() {
  if (ends) return;
  if (single) drive(*std::exchange(single, std::nullopt));
  if (ends) return;
  if (run == Run::threads) chain.finish();
  if (run != Run::course) return end_run();
  gather.finish();
  close_course();
}

void Planner::Impl::mark_at_rest(Entry::Kind kind, std::uint32_t event, Tag tag) {
  tag.marks = marks;
  in_turn([this, kind, event, tag] {
    finish();
    if (ends)
      behind.push_front([this, kind, event, tag] { mark(kind, event, tag); });
    else
      mark(kind, event, tag);
  });
}

/// A window at most, and what waits behind a rest that is planned now. False: nothing was to be done.
bool Planner::Impl::plan() {
  const bool worked = course->work();
  if (!ends) return fall_back() || worked;
  if (course->ends()) return worked;
  close_course();
  while (!ends && !behind.empty()) {
    const std::function<void()> next = std::move(behind.front());
    behind.pop_front();
    next();
  }
  return true;
}

Planner::Planner(const Config& config, Track& track, MomentSink* forecast)
    : impl_(std::make_unique<Impl>(config, track, forecast)) {}
Planner::~Planner() = default;

Track::Begin Planner::restart(const Vector& at) {
  Impl& p = *impl_;
  const Track::Begin begin = p.publisher.next();
  p.law.restart();
  p.course->restart();
  p.forget();
  p.at = p.added = at;
  Tag tag;
  tag.marks = p.marks;
  p.mark(Entry::Kind::restart, 0, tag);
  return begin;
}

bool Planner::add(const Element& element) {
  Impl& p = *impl_;
  const Shaped shaped = shape(p.config, p.added, element);
  p.flaw = shaped.flaw;
  if (p.flaw != Flaw::none) return false;
  Element marked = element;
  marked.tag.marks = p.marks;
  p.added = element.to;
  p.in_turn([&p, marked, piece = shaped.piece] { p.add(marked, piece); });
  return true;
}

Flaw Planner::last_flaw() const { return impl_->flaw; }

std::optional<Tag> Planner::take_unasked_rest() { return std::exchange(impl_->unasked_rest, std::nullopt); }

void Planner::rest() {
  impl_->in_turn([this] { impl_->finish(); });
}

void Planner::add_mark() { ++impl_->marks; }

void Planner::add_event(std::uint32_t id, const Tag& tag) {
  impl_->mark_at_rest(Entry::Kind::event, id, tag);
}

void Planner::finish() { impl_->mark_at_rest(Entry::Kind::finish, 0, {}); }

bool Planner::wants_more() const { return !impl_->ends && impl_->publisher.wants_more(); }

bool Planner::ends() const { return impl_->ends; }

bool Planner::waits() const { return impl_->ends || impl_->publisher.waits(); }

double Planner::ahead(std::optional<double> driven) const { return impl_->publisher.ahead(driven); }

double Planner::planned() const { return impl_->publisher.planned(); }

void Planner::work() {
  while (impl_->plan()) {
  }
  impl_->publisher.work();
}

bool Planner::work_a_little() {
  const bool worked = impl_->plan();
  impl_->publisher.work();
  return worked;
}

const Vector& Planner::position() const { return impl_->added; }

}  // namespace servogate::path
