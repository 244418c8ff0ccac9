// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/planner.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "kernel/path/geometry/smoothing.hpp"
#include "kernel/path/lookahead.hpp"

namespace servogate::path {
namespace {

constexpr double kPlannedAhead = 2.0;       // s
constexpr double kBlendShare = 0.85;        // of the tolerance; the rest is for what is left out
constexpr double kLeftOutShare = 0.125;     // of the tolerance: elements shorter than half of it are left out
constexpr std::uint32_t kMostPieces = 512;  // in a span
constexpr double kPiecesPerCycle = 50.0;    // the most the cycle has to walk over
constexpr double kSpansPerCycle = 4.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A piece with its box, before it belongs to a span.
struct Bounded {
  Piece piece;
  Box box;
  double feed = 0.0;
  double per_turn = 0.0;
};

/// Sum of pieces that become one span.
struct OpenSpan {
  double length = 0.0, time = 0.0, feed = kInfinity, per_turn = 0.0, turns = 0.0;
  Box least{kInfinity, kInfinity, kInfinity};
};

/// Feed of an element as it goes into the spans: mm/s, and the revolutions a second that belong to it.
struct FeedOf {
  double feed = kInfinity;
  double turns = 0.0;
};

FeedOf feed_of(const Element& e) {
  if (e.kind == Element::Kind::rapid) return {};
  return {e.feed, e.revolutions};
}

/// Of a blend between two elements: the slower one, by the spindle where one of them is.
FeedOf slower(const Element& a, const Element& b) {
  if ((a.revolutions > 0.0) != (b.revolutions > 0.0)) {
    const Element& turned = a.revolutions > 0.0 ? a : b;
    const double share = std::min(1.0, std::min(a.feed, b.feed) / turned.feed);
    return {turned.feed * share, turned.revolutions};
  }
  return feed_of(a.feed <= b.feed ? a : b);
}

/// Stretches that may be driven as one: their feeds have the same master.
bool same_master(double per_turn, double turns, double other_per_turn, double other_turns) {
  if (per_turn == 0.0 || other_per_turn == 0.0) return per_turn == other_per_turn;
  return std::abs(per_turn - other_per_turn) <= 1e-3 * per_turn &&
         std::max(turns, other_turns) <= 1.05 * std::min(turns, other_turns);
}

double ramp_time(const Box& b) { return b.velocity / b.acceleration + b.acceleration / b.jerk; }

/// Time that is lost at most when a stretch of `length` and `time` with box `own` is driven with box
/// `common`.
double loss(double length, double time, const Box& own, const Box& common) {
  const double cruise = length / common.velocity - time;
  const double ramps = std::max(0.0, ramp_time({common.velocity, common.acceleration, common.jerk}) -
                                         ramp_time({common.velocity, own.acceleration, own.jerk}));
  return cruise + ramps * std::min(1.0, time / ramp_time(own));
}

Box least(const Box& a, const Box& b) {
  return {std::min(a.velocity, b.velocity), std::min(a.acceleration, b.acceleration),
          std::min(a.jerk, b.jerk)};
}

}  // namespace

struct Planner::Impl {
  Impl(const Config& c, Track& t)
      : config(c), track(t), lookahead(t.pieces.capacity() / 2), run(c.axis_count) {}

  Config config;
  Track& track;
  Lookahead lookahead;
  Flaw flaw = Flaw::none;

  Vector at{};                      // end of the elements added
  Vector shaped_to{};               // end of `waiting`, where the next geometry starts
  std::optional<Element> left_out;  // too short to matter, so far
  double left_out_length = 0.0;
  std::optional<Piece> waiting;  // last element, its end not decided
  Element waiting_element;
  double waiting_from = 0.0;  // what the blend at its start has taken

  Smoothing run;  // of short lines; `waiting` is its last one
  struct RunLine {
    FeedOf feed;
    double corner;  // speed allowed at its end
  };
  std::deque<RunLine> run_lines;
  std::size_t run_done = 0;  // lines before run_lines[0]
  std::vector<Smoothing::Slice> slices;
  double run_tolerance = 0.0;

  OpenSpan open;
  std::vector<Bounded> open_pieces;
  std::uint64_t next_piece = 0;
  double time = 0.0;        // running sum over the pieces
  double final_time = 0.0;  // the same up to the last final span

  std::deque<Piece> pieces_out;
  std::deque<Entry> entries_out;
  std::vector<Entry> fresh;

  bool add(const Element& e);
  bool add_shaped(const Element& e);
  void put_left_out();
  bool leave_out(const Element& e);
  bool always_stops(const Element& e) const;
  bool corner_stops(const Piece& next) const;
  double corner_speed(const Piece& next) const;
  void join(const Element& e, const Piece& next);
  bool join_run(const Element& e, const Piece& next);
  void take_run(bool end);
  void end_run();
  double joint_tolerance(const Element& e) const;
  void put_rest_of_waiting();
  void put(const Piece& piece, const FeedOf& feed, double corner_cap);
  void close_span();
  void rest(bool confirm);
  void collect();
  void mark(Entry::Kind kind, std::uint32_t event, const Tag& tag, const Vector& where);
  void flush();
  void work();
  bool wants_more() const;
};

bool Planner::Impl::leave_out(const Element& e) {
  if (e.kind != Element::Kind::line || !waiting || e.transition.continuation == Continuation::exact_stop)
    return false;
  if (waiting_element.transition.continuation == Continuation::exact_stop ||
      waiting_element.kind == Element::Kind::rapid)
    return false;
  if (e.transition.continuation == Continuation::corner_limited && e.transition.erf <= 0.0) return false;
  double length = 0.0;
  for (int i = 0; i < config.axis_count; ++i) length += (e.to[i] - at[i]) * (e.to[i] - at[i]);
  length = std::sqrt(length);
  const double tolerance = std::min(e.transition.tolerance, waiting_element.transition.tolerance);
  if (left_out_length + length > kLeftOutShare * tolerance) return false;
  left_out_length += length;
  left_out = e;
  at = e.to;
  return true;
}

void Planner::Impl::put_left_out() {
  if (!left_out) return;
  const Element e = *left_out;
  left_out.reset();
  add_shaped(e);
}

bool Planner::Impl::add(const Element& e) {
  flaw = shape(config, at, e).flaw;
  if (flaw != Flaw::none) return false;
  if (leave_out(e)) return true;
  // Only a line can start elsewhere by so little.
  if (e.kind != Element::Kind::line || (waiting && always_stops(e))) put_left_out();
  left_out.reset();
  left_out_length = 0.0;
  return add_shaped(e);
}

bool Planner::Impl::add_shaped(const Element& e) {
  const Shaped next = shape(config, shaped_to, e);
  at = e.to;
  if (next.piece.length == 0.0) {
    // Nothing moves: the element only decides how the one before ends.
    if (waiting &&
        (e.transition.continuation == Continuation::exact_stop || e.kind == Element::Kind::rapid)) {
      waiting_element.transition.continuation = Continuation::exact_stop;
      waiting_element.transition.confirm |= e.transition.confirm;
    }
    return true;
  }
  if (waiting) join(e, next.piece);
  waiting = next.piece;
  waiting_element = e;
  shaped_to = e.to;
  return true;
}

bool Planner::Impl::always_stops(const Element& e) const {
  const Transition& t = waiting_element.transition;
  if (t.continuation == Continuation::exact_stop || !(t.tolerance > 0.0)) return true;
  if (waiting_element.kind == Element::Kind::rapid || e.kind == Element::Kind::rapid) return true;
  return t.continuation == Continuation::corner_limited && t.erf <= 0.0;
}

bool Planner::Impl::corner_stops(const Piece& next) const {
  const Transition& t = waiting_element.transition;
  return t.continuation == Continuation::corner_limited &&
         turn(*waiting, next, config.axis_count) > t.max_angle_deg / 180.0 * std::numbers::pi + 1e-9;
}

double Planner::Impl::corner_speed(const Piece& next) const {
  const Transition& t = waiting_element.transition;
  if (t.continuation != Continuation::corner_limited) return kInfinity;
  const double s = std::cos(0.5 * turn(*waiting, next, config.axis_count));
  if (s >= 1.0) return kInfinity;
  double a = kInfinity;
  const Vector before = evaluate(*waiting, waiting->length, config.axis_count).d1;
  const Vector after = evaluate(next, 0.0, config.axis_count).d1;
  for (int i = 0; i < config.axis_count; ++i)
    if (std::abs(before[i]) + std::abs(after[i]) > 1e-9) a = std::min(a, config.limits[i].acceleration);
  return std::sqrt(a * t.erf * s / (1.0 - s));
}

double Planner::Impl::joint_tolerance(const Element& e) const {
  const double own = waiting_element.transition.tolerance;
  return kBlendShare * (e.transition.tolerance > 0.0 ? std::min(own, e.transition.tolerance) : own);
}

void Planner::Impl::take_run(bool end) {
  run.take(end, slices);
  for (const Smoothing::Slice& slice : slices) {
    while (run_done + 1 < slice.line) {
      run_lines.pop_front();
      ++run_done;
    }
    // A slice may touch the corners at both ends of its line.
    const RunLine& line = run_lines[slice.line - run_done];
    const double before = slice.line > run_done ? run_lines[slice.line - run_done - 1].corner : kInfinity;
    put(slice.piece, line.feed, std::min(before, line.corner));
  }
  slices.clear();
  if (end) {
    run_lines.clear();
    run_done = 0;
    waiting_from = 0.5 * waiting->length;
  }
}

/// Makes the two lines part of a run of short lines, where they suit.
bool Planner::Impl::join_run(const Element& e, const Piece& next) {
  const int n = config.axis_count;
  const double tolerance = joint_tolerance(e);
  const bool suits = Smoothing::suits(*waiting, next, tolerance, n);
  if (!suits || (run.empty() && joins_smoothly(*waiting, next, n))) return false;
  if (run.empty()) {
    const double left = 0.5 * waiting->length - waiting_from;
    if (left > 1e-12) put(part(*waiting, waiting_from, left), feed_of(waiting_element), kInfinity);
    run.begin(*waiting, tolerance);
    run_tolerance = tolerance;
  } else if (tolerance != run_tolerance) {
    return false;
  }
  run_lines.push_back({feed_of(waiting_element), corner_speed(next)});
  run.append(next);
  take_run(false);
  return true;
}

void Planner::Impl::join(const Element& e, const Piece& next) {
  const int n = config.axis_count;
  const bool passes = !always_stops(e) && !corner_stops(next);
  if (passes && join_run(e, next)) return;
  end_run();
  if (passes) {
    if (joins_smoothly(*waiting, next, n)) {
      put_rest_of_waiting();
      waiting_from = 0.0;
      return;
    }
    if (auto found = blend(*waiting, next, joint_tolerance(e), n)) {
      Piece& b = found->piece;
      const double left = waiting->length - found->trim - waiting_from;
      if (left > 1e-12) put(part(*waiting, waiting_from, left), feed_of(waiting_element), kInfinity);
      b.tag_before = waiting->tag;
      b.tag = next.tag;
      b.target = next.target;
      b.rest = next.length - found->trim;
      put(b, slower(waiting_element, e), corner_speed(next));
      waiting_from = found->trim;
      return;
    }
  }
  put_rest_of_waiting();
  rest(waiting_element.transition.confirm &&
       waiting_element.transition.continuation == Continuation::exact_stop);
}

void Planner::Impl::end_run() {
  if (run.empty()) return;
  run_lines.push_back({feed_of(waiting_element), kInfinity});
  take_run(true);
}

void Planner::Impl::put_rest_of_waiting() {
  put(part(*waiting, waiting_from, waiting->length - waiting_from), feed_of(waiting_element), kInfinity);
  waiting_from = 0.0;
}

void Planner::Impl::put(const Piece& piece, const FeedOf& feed, double corner_cap) {
  Bounded next{piece, {}, feed.feed / path_rate(config, piece), 0.0};
  if (feed.turns > 0.0) next.per_turn = next.feed / feed.turns;
  next.box = box(config, piece, std::min(corner_cap, next.feed * config.largest_override));
  next.feed = std::min(next.feed, next.box.velocity);
  const double own_time = piece.length / next.box.velocity;
  if (!open_pieces.empty()) {
    const Box common = least(open.least, next.box);
    const double lost =
        loss(open.length, open.time, open.least, common) + loss(piece.length, own_time, next.box, common);
    const double scale = common.acceleration / common.jerk;
    const bool same_feed = std::abs(next.feed - open.feed) <= 1e-3 * open.feed;
    const bool short_ones = std::min(open.time, own_time) < 0.5 * scale;
    const bool worth = same_master(open.per_turn, open.turns, next.per_turn, feed.turns) &&
                       lost <= 0.5 * std::min(open.time + own_time, scale) && (same_feed || short_ones);
    if (!worth || open_pieces.size() >= std::min(kMostPieces, track.pieces.capacity() / 16)) close_span();
  }
  open.length += piece.length;
  open.time += own_time;
  open.least = least(open.least, next.box);
  open.feed = std::min(open.feed, next.feed);
  open.per_turn = open_pieces.empty() ? next.per_turn : std::min(open.per_turn, next.per_turn);
  open.turns = std::max(open.turns, feed.turns);
  open_pieces.push_back(next);
}

void Planner::Impl::close_span() {
  if (open_pieces.empty()) return;
  Span span;
  span.first_piece = next_piece;
  span.pieces = static_cast<std::uint32_t>(open_pieces.size());
  span.length = open.length;
  span.box = open.least;
  const double per_cycle = std::min(kSpansPerCycle, kPiecesPerCycle / span.pieces);
  span.box.velocity = std::min(span.box.velocity, per_cycle * span.length / config.period_s);
  span.feed = std::min(open.feed, span.box.velocity);
  span.per_turn = open.per_turn;
  span.turns = open.turns;
  double start = 0.0;
  for (Bounded& b : open_pieces) {
    b.piece.start = start;
    start += b.piece.length;
    time += b.piece.length / span.box.velocity;
    b.piece.time = time;
    pieces_out.push_back(b.piece);
  }
  span.time = time;
  span.length = start;
  next_piece += span.pieces;
  open = OpenSpan{};
  open_pieces.clear();
  lookahead.append(span, fresh);
  collect();
}

void Planner::Impl::collect() {
  for (const Entry& entry : fresh) {
    entries_out.push_back(entry);
    if (entry.span.final) final_time = std::max(final_time, entry.span.time);
  }
  fresh.clear();
}

void Planner::Impl::rest(bool confirm) {
  close_span();
  lookahead.rest(confirm, fresh);
  collect();
}

void Planner::Impl::flush() {
  put_left_out();
  left_out_length = 0.0;
  if (waiting) {
    end_run();
    put_rest_of_waiting();
    rest(waiting_element.transition.confirm &&
         waiting_element.transition.continuation == Continuation::exact_stop);
    waiting.reset();
  }
}

void Planner::Impl::mark(Entry::Kind kind, std::uint32_t event, const Tag& tag, const Vector& where) {
  Entry entry;
  entry.kind = kind;
  entry.event = event;
  entry.tag = tag;
  entry.at = where;
  entry.span.number = lookahead.last_number();
  entries_out.push_back(entry);
}

void Planner::Impl::work() {
  while (!pieces_out.empty() && track.pieces.push(pieces_out.front())) pieces_out.pop_front();
  const std::uint64_t there = track.pieces.written();
  while (!entries_out.empty()) {
    const Entry& entry = entries_out.front();
    if (entry.kind == Entry::Kind::span && entry.span.first_piece + entry.span.pieces > there) break;
    if (!track.entries.push(entry)) break;
    entries_out.pop_front();
  }
}

bool Planner::Impl::wants_more() const {
  if (!entries_out.empty()) return false;
  const std::uint64_t freed = track.pieces.freed(), there = track.pieces.written();
  return freed >= there || final_time - track.pieces[freed].time < kPlannedAhead;
}

Planner::Planner(const Config& config, Track& track) : impl_(std::make_unique<Impl>(config, track)) {}
Planner::~Planner() = default;

Track::Begin Planner::restart(const Vector& at) {
  Impl& p = *impl_;
  const Track::Begin begin{p.track.entries.written() + p.entries_out.size(), p.next_piece};
  p.left_out.reset();
  p.left_out_length = 0.0;
  p.waiting.reset();
  p.waiting_from = 0.0;
  p.run = Smoothing(p.config.axis_count);
  p.run_lines.clear();
  p.run_done = 0;
  p.open = OpenSpan{};
  p.open_pieces.clear();
  p.lookahead.clear();
  p.at = p.shaped_to = at;
  p.mark(Entry::Kind::restart, 0, {}, at);
  return begin;
}

bool Planner::add(const Element& element) { return impl_->add(element); }
Flaw Planner::last_flaw() const { return impl_->flaw; }

void Planner::add_event(std::uint32_t id, const Tag& tag) {
  impl_->flush();
  impl_->mark(Entry::Kind::event, id, tag, impl_->at);
}

void Planner::finish() {
  impl_->flush();
  impl_->mark(Entry::Kind::finish, 0, {}, impl_->at);
}

bool Planner::wants_more() const { return impl_->wants_more(); }
void Planner::work() { impl_->work(); }
const Vector& Planner::position() const { return impl_->at; }

}  // namespace servogate::path
