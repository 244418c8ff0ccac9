// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/thread_chain.hpp"

#include <cmath>

#include "kernel/path/shape/gather.hpp"

namespace servogate::path {
namespace {

constexpr double kCornerShare = 0.85;    // of the tolerance; the rest is for what is left out
constexpr double kLeftOutShare = 0.125;  // of the tolerance: elements shorter than half of it are left out
constexpr double kNothing = 1e-12;       // mm

}  // namespace

ThreadChain::ThreadChain(const Config& config, ChainSink& sink)
    : config_(config), sink_(sink), run_(config.axis_count) {}

void ThreadChain::restart(const Vector& at) {
  left_out_.reset();
  left_out_length_ = 0.0;
  waiting_.reset();
  waiting_from_ = 0.0;
  run_ = Smoothing(config_.axis_count);
  run_lines_.clear();
  run_done_ = 0;
  at_ = shaped_to_ = at;
}

bool ThreadChain::leave_out(const Element& e) {
  if (!waiting_ || !goes_on(e) || !goes_on(waiting_element_)) return false;
  double square = 0.0;
  for (int i = 0; i < config_.axis_count; ++i) square += (e.to[i] - at_[i]) * (e.to[i] - at_[i]);
  const double length = std::sqrt(square);
  const double tolerance = std::min(e.transition.tolerance, waiting_element_.transition.tolerance);
  if (left_out_length_ + length > kLeftOutShare * tolerance) return false;
  left_out_length_ += length;
  left_out_ = e;
  at_ = e.to;
  return true;
}

void ThreadChain::put_left_out() {
  if (!left_out_) return;
  const Element e = *left_out_;
  left_out_.reset();
  add_shaped(e);
}

void ThreadChain::add(const Element& e) {
  if (leave_out(e)) return;
  if (waiting_ && !goes_on(waiting_element_)) put_left_out();
  left_out_.reset();
  left_out_length_ = 0.0;
  add_shaped(e);
}

void ThreadChain::add_shaped(const Element& e) {
  const Shaped next = shape(config_, shaped_to_, e);
  at_ = e.to;
  if (next.piece.length == 0.0) return;
  if (waiting_) join(e, next.piece);
  waiting_ = next.piece;
  waiting_element_ = e;
  shaped_to_ = e.to;
}

double ThreadChain::joint_tolerance(const Element& e) const {
  const double own = waiting_element_.transition.tolerance;
  return kCornerShare * (e.transition.tolerance > 0.0 ? std::min(own, e.transition.tolerance) : own);
}

void ThreadChain::take_run(bool end) {
  run_.take(end, slices_);
  for (const Smoothing::Slice& slice : slices_) {
    while (run_done_ + 1 < slice.line) {
      run_lines_.pop_front();
      ++run_done_;
    }
    sink_.put(slice.piece, run_lines_[slice.line - run_done_]);
  }
  slices_.clear();
  if (end) {
    run_lines_.clear();
    run_done_ = 0;
    waiting_from_ = 0.5 * waiting_->length;
  }
}

/// Makes the two lines part of a run of short lines, where they suit.
bool ThreadChain::join_run(const Element& e, const Piece& next) {
  const int n = config_.axis_count;
  const double tolerance = joint_tolerance(e);
  const bool suits = Smoothing::suits(*waiting_, next, tolerance, n);
  if (!suits || (run_.empty() && joins_smoothly(*waiting_, next, n))) return false;
  if (run_.empty()) {
    const double left = 0.5 * waiting_->length - waiting_from_;
    if (left > kNothing) sink_.put(part(*waiting_, waiting_from_, left), waiting_element_);
    run_.begin(*waiting_, tolerance);
    run_tolerance_ = tolerance;
  } else if (tolerance != run_tolerance_) {
    return false;
  }
  run_lines_.push_back(waiting_element_);
  run_.append(next);
  take_run(false);
  return true;
}

void ThreadChain::join(const Element& e, const Piece& next) {
  const int n = config_.axis_count;
  const bool passes = goes_on(waiting_element_);
  if (passes && join_run(e, next)) return;
  end_run();
  if (passes) {
    if (joins_smoothly(*waiting_, next, n)) return put_rest_of_waiting();
    if (const auto corner = blend(*waiting_, next, joint_tolerance(e), n))
      return put_corner(e, next, *corner);
  }
  put_rest_of_waiting();
  sink_.rest();
}

/// In two halves, so that the element in motion changes in the middle. Each is bounded for the faster
/// element: nothing slows down into it.
void ThreadChain::put_corner(const Element& e, const Piece& next, const Blend& corner) {
  const double left = waiting_->length - corner.trim - waiting_from_, half = 0.5 * corner.piece.length;
  if (left > kNothing) sink_.put(part(*waiting_, waiting_from_, left), waiting_element_);
  const Element& pace = waiting_element_.feed <= e.feed ? e : waiting_element_;
  Piece first = part(corner.piece, 0.0, half), second = part(corner.piece, half, half);
  first.tag = waiting_->tag;
  first.target = waiting_->target;
  first.rest = 0.0;
  second.tag = next.tag;
  second.target = next.target;
  second.rest = next.length - corner.trim;
  sink_.put(first, pace);
  sink_.put(second, pace);
  waiting_from_ = corner.trim;
}

void ThreadChain::end_run() {
  if (run_.empty()) return;
  run_lines_.push_back(waiting_element_);
  take_run(true);
}

void ThreadChain::put_rest_of_waiting() {
  sink_.put(part(*waiting_, waiting_from_, waiting_->length - waiting_from_), waiting_element_);
  waiting_from_ = 0.0;
}

void ThreadChain::finish() {
  put_left_out();
  left_out_length_ = 0.0;
  if (!waiting_) return;
  end_run();
  put_rest_of_waiting();
  sink_.rest();
  waiting_.reset();
}

}  // namespace servogate::path
