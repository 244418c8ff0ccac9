// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/path/axes/transformation.hpp"
#include "kernel/path/law/judge.hpp"

namespace servogate::path {
namespace {

// A knot interval lasts so long that a jerk at its limit does not leave the tolerance in it.
constexpr double kStep = 0.4, kUnit = 0.001, kShortest = 0.001, kLongest = 0.008;  // s

}  // namespace

Pipeline::Pipeline(const Settings& settings, KnotSink& sink)
    : settings_(settings),
      sink_(sink),
      run_(settings.axes),
      estimate_(settings.axes, *settings.transformation, kUnit) {
  for (int n = 0; n < settings.passes; ++n) {
    TubeWindows::Settings t;
    t.axes = settings.axes;
    t.first = n == 0;
    SpeedWindows::Settings s;
    s.axes = settings.axes;
    s.reserve = settings.reserve;
    s.transformation = settings.transformation;
    s.judged = n + 1 == settings.passes;
    passes_.push_back(std::make_unique<Pass>(t, s, settings.axes));
  }
}

double Pipeline::step_of(const Leg& leg) const {
  double jerk = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings_.axes); ++i)
    if (moves(leg, i)) jerk = std::max(jerk, (*leg.limits)[i].jerk);
  return std::clamp(std::round(kStep * std::cbrt(leg.tolerance / jerk) / kUnit) * kUnit, kShortest, kLongest);
}

void Pipeline::begin_run() {
  begun_ = true;
  broken_ = false;
  ++counts_.runs;
  const double step = step_of(run_.leg(run_.first()));
  estimate_.clear(step);
  for (auto& pass : passes_) {
    pass->even.clear(step);
    pass->tube.clear(step);
    pass->speed.clear(step);
    pass->places.clear();
    pass->beta.clear();
    pass->start.clear();
    pass->controls.clear();
  }
  published_ = 0;
  leg_ = run_.first();
  time_ = {};
}

void Pipeline::add(const Leg& leg) {
  if (!end_) return run_.append(leg);
  behind_.push_back({Order::Kind::leg, leg, 0.0});
}

void Pipeline::end() { take({Order::Kind::rest, {}, 0.0}); }

void Pipeline::cruise(const Leg& leg, double speed) { take({Order::Kind::cruise, leg, speed}); }

void Pipeline::take(const Order& order) {
  if (end_) return behind_.push_back(order);
  if (order.kind == Order::Kind::leg) return run_.append(order.leg);
  if (order.kind == Order::Kind::rest && run_.empty()) return;
  run_.end_at(order.speed);
  end_ = order;
}

/// All of the run is put, or there is no law for the rest of it.
void Pipeline::close_run() {
  for (const auto& pass : passes_) count(*pass);
  const Order end = *std::exchange(end_, std::nullopt);
  begun_ = false;
  run_.clear(end.speed);
  if (end.kind == Order::Kind::rest)
    sink_.rest();
  else
    sink_.cruise({end.leg.piece, end.leg.piece.length / end.speed});
  for (; !end_ && !behind_.empty(); behind_.pop_front()) take(behind_.front());
}

void Pipeline::abandon() {
  run_.clear();
  begun_ = broken_ = false;
  end_.reset();
  behind_.clear();
}

bool Pipeline::work() {
  if (!end_ && run_.empty()) return false;
  if (!begun_) begin_run();
  if (!broken_ && advance()) {
    publish();
    forget();
    return true;
  }
  if (!end_) return false;
  close_run();
  return true;
}

/// One window of the last pass that has something to do, so that what is known is put soon and little waits
/// between the passes.
bool Pipeline::advance() {
  for (std::size_t n = passes_.size(); n-- > 0;)
    if (work_pass(n)) return true;
  return false;
}

bool Pipeline::work_pass(std::size_t n) {
  Pass& pass = *passes_[n];
  const bool complete = n == 0 ? estimate_.done() : pass.even.done();
  if (pass.speed.work(run_, pass.places, pass.controls, pass.tube.done(), pass.beta) ||
      pass.tube.work(run_, pass.places, complete, pass.start, pass.controls)) {
    ++counts_.windows;
    return true;
  }
  return make_places(n);
}

bool Pipeline::make_places(std::size_t n) {
  Pass& pass = *passes_[n];
  if (n == 0) return estimate_.work(run_, end_.has_value(), pass.places);
  const Pass& before = *passes_[n - 1];
  const bool began = pass.places.empty();
  const bool made = pass.even.work(run_, before.places, before.controls, before.beta, before.speed.done(),
                                   before.speed.open(), pass.places, pass.start);
  if (began && made) {
    pass.tube.clear(pass.even.step());
    pass.speed.clear(pass.even.step());
  }
  return made;
}

void Pipeline::publish() {
  const Pass& last = *passes_.back();
  if (broken_) return;
  broken_ = last.speed.counts().failed > 0;
  if (last.beta.end() < 3) return;
  const double step = last.speed.step(), i1 = 1.0 / step;
  const std::size_t known = last.beta.end() - 1;  // knots
  if (published_ == 0) sink_.begin(last.controls[0], last.controls[1]);
  for (; published_ < known; ++published_) {
    const std::size_t k = published_;
    if (k > 0) time_ = time_.plus(interval_time({&last.beta[k - 1], 3}, 0, step));
    Knot knot;
    knot.t = time_;
    knot.w = std::sqrt(0.5 * (last.beta[k] + last.beta[k + 1])) * i1;
    knot.a = 0.5 * (last.beta[k + 1] - last.beta[k]) * i1 * i1;
    knot.place = last.places[k];
    knot.control = last.controls[k + 2];
    leg_ = run_.leg_at(knot.place, leg_);
    knot.turns = turns_at(run_.leg(leg_), run_.at(knot.place, leg_), knot.place);
    sink_.put(knot);
    ++counts_.knots;
  }
}

void Pipeline::forget() {
  double u = estimate_.needs_from();
  for (std::size_t n = 0; n < passes_.size(); ++n) {
    Pass& pass = *passes_[n];
    std::size_t from = std::min(pass.tube.needs_from(), pass.speed.needs_from());
    if (n + 1 < passes_.size()) from = std::min(from, passes_[n + 1]->even.needs_from());
    if (n + 1 == passes_.size()) from = std::min(from, published_ > 0 ? published_ - 1 : 0);
    from = from > 1 ? from - 1 : 0;
    if (!pass.places.empty()) u = std::min(u, pass.places[std::min(from, pass.places.end() - 1)]);
    pass.places.forget_before(from);
    pass.controls.forget_before(from);
    pass.beta.forget_before(from);
    pass.start.forget_before(pass.tube.needs_from());
  }
  run_.forget_before(u);
}

void Pipeline::count(const Pass& pass) {
  const bool last = &pass == passes_.back().get();
  if (last) counts_.released += pass.tube.counts().released;
  if (last) counts_.outside += pass.tube.counts().outside;
  if (last) counts_.failed += pass.speed.counts().failed;
  counts_.repaired += pass.speed.counts().repaired;
  counts_.tube_steps += pass.tube.counts().knot_steps;
  counts_.law_steps += pass.speed.counts().knot_steps;
}

std::size_t Pipeline::kept() const {
  std::size_t n = run_.end() - run_.first();
  for (const auto& pass : passes_) n += pass->controls.end() - pass->controls.begin();
  return n;
}

}  // namespace servogate::path
