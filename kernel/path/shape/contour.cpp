// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::path {
namespace {

constexpr double kBlendShare = 0.85;     // of the tolerance; the rest is for what is left out
constexpr double kLeftOutShare = 0.125;  // of the tolerance: elements shorter than half of it are left out
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Pace pace_of(const Element& e) {
  if (e.kind == Element::Kind::rapid) return {};
  return {e.feed, e.revolutions, e.lock, kInfinity};
}

/// Of a blend between two elements: the slower one, by the spindle where one of them is.
Pace slower(const Element& a, const Element& b) {
  if ((a.revolutions > 0.0) != (b.revolutions > 0.0)) {
    const Element& turned = a.revolutions > 0.0 ? a : b;
    const double share = std::min(1.0, std::min(a.feed, b.feed) / turned.feed);
    return {turned.feed * share, turned.revolutions, {}, kInfinity};
  }
  // By the spindle's angle the blend is bounded for the faster one: nothing slows down into it.
  if (a.lock.kind != Lock::Kind::none) return pace_of(a.feed <= b.feed ? b : a);
  return pace_of(a.feed <= b.feed ? a : b);
}

Pace capped(Pace pace, double cap) {
  pace.cap = cap;
  return pace;
}

}  // namespace

Contour::Contour(const Config& config, ContourSink& sink)
    : config_(config), sink_(sink), run_(config.axis_count) {}

void Contour::restart(const Vector& at) {
  left_out_.reset();
  left_out_length_ = 0.0;
  waiting_.reset();
  waiting_from_ = 0.0;
  run_ = Smoothing(config_.axis_count);
  run_lines_.clear();
  run_done_ = 0;
  at_ = shaped_to_ = at;
}

bool Contour::leave_out(const Element& e) {
  if (e.kind != Element::Kind::line || !waiting_ || e.transition.continuation == Continuation::exact_stop)
    return false;
  if (waiting_element_.transition.continuation == Continuation::exact_stop ||
      waiting_element_.kind == Element::Kind::rapid)
    return false;
  if (e.transition.continuation == Continuation::corner_limited && e.transition.erf <= 0.0) return false;
  double length = 0.0;
  for (int i = 0; i < config_.axis_count; ++i) length += (e.to[i] - at_[i]) * (e.to[i] - at_[i]);
  length = std::sqrt(length);
  const double tolerance = std::min(e.transition.tolerance, waiting_element_.transition.tolerance);
  if (left_out_length_ + length > kLeftOutShare * tolerance) return false;
  left_out_length_ += length;
  left_out_ = e;
  at_ = e.to;
  return true;
}

void Contour::put_left_out() {
  if (!left_out_) return;
  const Element e = *left_out_;
  left_out_.reset();
  add_shaped(e);
}

bool Contour::add(const Element& e) {
  flaw_ = shape(config_, at_, e).flaw;
  if (flaw_ != Flaw::none) return false;
  if (leave_out(e)) return true;
  // Only a line can start elsewhere by so little.
  if (e.kind != Element::Kind::line || (waiting_ && always_stops(e))) put_left_out();
  left_out_.reset();
  left_out_length_ = 0.0;
  return add_shaped(e);
}

bool Contour::add_shaped(const Element& e) {
  const Shaped next = shape(config_, shaped_to_, e);
  at_ = e.to;
  if (next.piece.length == 0.0) {
    // Nothing moves: the element only decides how the one before ends.
    if (waiting_ &&
        (e.transition.continuation == Continuation::exact_stop || e.kind == Element::Kind::rapid)) {
      waiting_element_.transition.continuation = Continuation::exact_stop;
      waiting_element_.transition.confirm |= e.transition.confirm;
    }
    return true;
  }
  if (waiting_) join(e, next.piece);
  waiting_ = next.piece;
  waiting_element_ = e;
  shaped_to_ = e.to;
  return true;
}

bool Contour::always_stops(const Element& e) const {
  const Transition& t = waiting_element_.transition;
  if (t.continuation == Continuation::exact_stop || !(t.tolerance > 0.0)) return true;
  if (waiting_element_.kind == Element::Kind::rapid || e.kind == Element::Kind::rapid) return true;
  if (waiting_element_.lock.kind != e.lock.kind || e.lock.kind > Lock::Kind::thread) return true;
  return t.continuation == Continuation::corner_limited && t.erf <= 0.0;
}

bool Contour::corner_stops(const Piece& next) const {
  const Transition& t = waiting_element_.transition;
  return t.continuation == Continuation::corner_limited &&
         turn(*waiting_, next, config_.axis_count) > t.max_angle_deg / 180.0 * std::numbers::pi + 1e-9;
}

double Contour::corner_speed(const Piece& next) const {
  const Transition& t = waiting_element_.transition;
  if (t.continuation != Continuation::corner_limited) return kInfinity;
  const double s = std::cos(0.5 * turn(*waiting_, next, config_.axis_count));
  if (s >= 1.0) return kInfinity;
  double a = kInfinity;
  const Vector before = evaluate(*waiting_, waiting_->length, config_.axis_count).d1;
  const Vector after = evaluate(next, 0.0, config_.axis_count).d1;
  for (int i = 0; i < config_.axis_count; ++i)
    if (std::abs(before[i]) + std::abs(after[i]) > 1e-9) a = std::min(a, config_.limits[i].acceleration);
  return std::sqrt(a * t.erf * s / (1.0 - s));
}

double Contour::joint_tolerance(const Element& e) const {
  const double own = waiting_element_.transition.tolerance;
  return kBlendShare * (e.transition.tolerance > 0.0 ? std::min(own, e.transition.tolerance) : own);
}

void Contour::take_run(bool end) {
  run_.take(end, slices_);
  for (const Smoothing::Slice& slice : slices_) {
    while (run_done_ + 1 < slice.line) {
      run_lines_.pop_front();
      ++run_done_;
    }
    // A slice may touch the corners at both ends of its line.
    const RunLine& line = run_lines_[slice.line - run_done_];
    const double before = slice.line > run_done_ ? run_lines_[slice.line - run_done_ - 1].corner : kInfinity;
    sink_.put(slice.piece, capped(line.pace, std::min(before, line.corner)));
  }
  slices_.clear();
  if (end) {
    run_lines_.clear();
    run_done_ = 0;
    waiting_from_ = 0.5 * waiting_->length;
  }
}

/// Makes the two lines part of a run of short lines, where they suit.
bool Contour::join_run(const Element& e, const Piece& next) {
  const int n = config_.axis_count;
  const double tolerance = joint_tolerance(e);
  const bool suits = Smoothing::suits(*waiting_, next, tolerance, n);
  if (!suits || (run_.empty() && joins_smoothly(*waiting_, next, n))) return false;
  if (run_.empty()) {
    const double left = 0.5 * waiting_->length - waiting_from_;
    if (left > 1e-12) sink_.put(part(*waiting_, waiting_from_, left), pace_of(waiting_element_));
    run_.begin(*waiting_, tolerance);
    run_tolerance_ = tolerance;
  } else if (tolerance != run_tolerance_) {
    return false;
  }
  run_lines_.push_back({pace_of(waiting_element_), corner_speed(next)});
  run_.append(next);
  take_run(false);
  return true;
}

void Contour::join(const Element& e, const Piece& next) {
  const int n = config_.axis_count;
  const bool passes = !always_stops(e) && !corner_stops(next);
  if (passes && join_run(e, next)) return;
  end_run();
  if (passes) {
    if (joins_smoothly(*waiting_, next, n)) return put_rest_of_waiting();
    if (auto found = blend(*waiting_, next, joint_tolerance(e), n)) {
      Piece& b = found->piece;
      const double left = waiting_->length - found->trim - waiting_from_;
      if (left > 1e-12) sink_.put(part(*waiting_, waiting_from_, left), pace_of(waiting_element_));
      b.tag_before = waiting_->tag;
      b.tag = next.tag;
      b.target = next.target;
      b.rest = next.length - found->trim;
      sink_.put(b, capped(slower(waiting_element_, e), corner_speed(next)));
      waiting_from_ = found->trim;
      return;
    }
  }
  put_rest_of_waiting();
  rest_behind_waiting();
}

void Contour::end_run() {
  if (run_.empty()) return;
  run_lines_.push_back({pace_of(waiting_element_), kInfinity});
  take_run(true);
}

void Contour::put_rest_of_waiting() {
  sink_.put(part(*waiting_, waiting_from_, waiting_->length - waiting_from_), pace_of(waiting_element_));
  waiting_from_ = 0.0;
}

void Contour::rest_behind_waiting() {
  const Transition& t = waiting_element_.transition;
  sink_.rest(t.confirm && t.continuation == Continuation::exact_stop);
}

void Contour::finish() {
  put_left_out();
  left_out_length_ = 0.0;
  if (!waiting_) return;
  end_run();
  put_rest_of_waiting();
  rest_behind_waiting();
  waiting_.reset();
}

}  // namespace servogate::path
