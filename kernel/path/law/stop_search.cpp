// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/stop_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace servogate::path {
namespace {

constexpr double kShare = 0.993;        // of the limits: what may lie between two places
constexpr double kInside = 1.0 - 1e-9;  // of an interval: the place is surely in it
constexpr double kNearly = 1e-3;

}  // namespace

bool StopSearch::Spot::inside(const LawTime& at) noexcept {
  in = at.since(interval.begin());
  return in > 0.0 && in < kInside * interval.seconds();
}

bool StopSearch::Spot::go(const CourseView& view, const RateLimits& limits, const LawTime& at) noexcept {
  if (interval.knot() != 0 && inside(at)) return true;
  if (!place.go(at)) return false;
  if (interval.knot() != place.knot() && !interval.take(view, place.knot(), limits)) return false;
  in = std::clamp(at.since(interval.begin()), 0.0, interval.seconds());
  return true;
}

LawTime StopSearch::time_at(double passed) const noexcept { return from_.time.plus(sense_ * passed); }

void StopSearch::begin(const CourseState& from, double within) noexcept {
  constexpr double kLeastPiece = 0.002;
  from_ = from;
  sense_ = from.rate < 0.0 ? -1.0 : 1.0;
  full_ = std::max(1.0, std::abs(from.rate));
  best_ = within;
  here_ = {};
  piece_ = std::max(kLeastPiece, within / (StopPlan::kMostPieces - 16));
  now_[0] = {};
  now_[0].rate = std::abs(from.rate);
  now_[0].slope = sense_ * from.slope;
  now_[0].knot = from.knot;
  count_ = 1;
  step_ = node_ = option_ = next_count_ = 0;
  found_ = verifying_ = false;
}

/// What the axes leave of bends in this place of an interval, in the sense of the motion.
bool StopSearch::bends(const Spot& spot, double in, const RateLimits& limits, double rate, double slope,
                       Range& range, int& places) const noexcept {
  --places;
  double least = 0.0, largest = 0.0;
  if (!spot.interval.bends(in, sense_ * rate, sense_ * slope, limits, kShare, least, largest)) return false;
  range.least = std::max(range.least, sense_ < 0.0 ? -largest : least);
  range.largest = std::min(range.largest, sense_ < 0.0 ? -least : largest);
  return range.least <= range.largest;
}

/// Takes a spot on from one node to the next; `range`: what is left of bends on both sides of the knots
/// between.
bool StopSearch::pass(const CourseView& view, const RateLimits& limits, Spot& spot, const Node& from,
                      const Node& to, Range& range, int& places) const noexcept {
  const LawTime at = time_at(to.passed);
  if (spot.inside(at)) return true;
  if (!spot.place.go(at)) return false;
  const bool on = sense_ > 0.0;
  while (spot.interval.knot() != spot.place.knot()) {
    const std::int64_t begin = begin_of(view, spot.interval.knot());
    const Knot* knot = view.knot(on ? spot.interval.knot() : begin);
    if (knot == nullptr || places < -kPast / 2) return false;
    const double there = sense_ * knot->t.since(from_.time), whole = to.passed - from.passed;
    const double share = whole > 0.0 ? std::clamp((there - from.passed) / whole, 0.0, 1.0) : 1.0;
    const double rate = from.rate + share * (to.rate - from.rate);
    const double slope = from.slope + share * (to.slope - from.slope);
    if (!bends(spot, on ? spot.interval.seconds() : 0.0, limits, rate, slope, range, places)) return false;
    if (!spot.interval.take(view, on ? next_of(view, spot.interval.knot()) : begin, limits)) return false;
    if (!bends(spot, on ? 0.0 : spot.interval.seconds(), limits, rate, slope, range, places)) return false;
  }
  spot.in = std::clamp(at.since(spot.interval.begin()), 0.0, spot.interval.seconds());
  return true;
}

/// One piece on.
void StopSearch::Node::go(double bend, double seconds) noexcept {
  const double bent = bend * seconds;
  passed += seconds * (rate + seconds * (0.5 * slope + bent / 6.0));
  rate += seconds * (slope + 0.5 * bent);
  slope += bent;
}

/// One step on, by the option of this number: shares of what the axes leave, or no bend where they leave
/// that. A bend holds for its piece, so it must fit at both ends and at the knots between.
bool StopSearch::follow(const CourseView& view, const RateLimits& limits, Spot& spot, std::size_t number,
                        Node& node, int& places) const noexcept {
  constexpr double kShares[] = {0.0, 0.25, 0.5, 0.75, 1.0};
  constexpr int kTries = 3;
  const double most = 1.0 / (piece_ * piece_ * kPieces * kPieces);
  for (double& bend : node.bends) {
    const Node from = node;
    const std::int64_t knot = spot.interval.knot();
    Range fits = from.range;
    fits.least = std::max(fits.least, -most);
    fits.largest = std::min(fits.largest, most);
    if (fits.least > fits.largest) return false;
    bend = number < std::size(kShares) ? fits.least + kShares[number] * (fits.largest - fits.least) : 0.0;
    bend = std::clamp(bend, fits.least, fits.largest);
    for (int n = 0;; ++n) {
      node.go(bend, piece_);
      if (n == kTries || !(node.rate > 0.0 && node.rate <= full_)) return false;
      Range way;
      node.range = {};
      if (!pass(view, limits, spot, from, node, way, places) ||
          !bends(spot, spot.in, limits, node.rate, node.slope, node.range, places))
        return false;
      const double least = std::max(way.least, node.range.least),
                   largest = std::min(way.largest, node.range.largest);
      const double nearly = kNearly * (std::abs(least) + std::abs(largest));
      if (bend >= least - nearly && bend <= largest + nearly) break;
      const double least_all = std::max(least, fits.least), largest_all = std::min(largest, fits.largest);
      if (least_all > largest_all) return false;
      node.passed = from.passed, node.rate = from.rate, node.slope = from.slope;
      spot.place.set_knot(knot);
      if (spot.interval.knot() != knot && !spot.interval.take(view, knot, limits)) return false;
      bend = std::clamp(bend, least_all, largest_all);
    }
  }
  node.knot = spot.place.knot();
  node.score = node.rate + node.slope * std::abs(node.slope) /
                               std::clamp(node.range.largest - node.range.least, 1e-6, 2.0 * most);
  return true;
}

/// One bend from here on comes to rest, and sooner than the best one.
bool StopSearch::closes(const CourseView& view, const RateLimits& limits, const Spot& spot, const Node& node,
                        double before, int& places) const noexcept {
  constexpr double kLooks = 48.0;
  if (!(node.slope < 0.0)) return false;
  const double bend = 0.5 * node.slope * node.slope / node.rate, seconds = -2.0 * node.rate / node.slope;
  if (before + seconds >= best_ || bend > node.range.largest || bend < node.range.least) return false;
  Spot at = spot;
  const double apart = std::max(0.002, seconds / kLooks);
  for (double t = 0.0; t < seconds; t += apart) {
    const double left = seconds - t;
    const RateState rate{sense_ * 0.5 * bend * left * left, -sense_ * bend * left, sense_ * bend, 0.0};
    const double passed = node.passed + bend * (seconds * seconds * seconds - left * left * left) / 6.0;
    --places;
    if (!at.go(view, limits, time_at(passed)) || !at.interval.keeps(at.in, rate, limits)) return false;
  }
  return true;
}

void StopSearch::expand(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  Node node = now_[node_];
  Spot spot(view, node.knot);
  spot.interval = here_;
  if (!spot.go(view, limits, time_at(node.passed))) return;
  here_ = spot.interval;
  if (step_ == 0 && !bends(spot, spot.in, limits, node.rate, node.slope, node.range, places)) return;
  const double before = static_cast<double>((step_ + 1) * kPieces) * piece_;
  node.parent = static_cast<std::uint8_t>(node_);
  if (!follow(view, limits, spot, option_, node, places)) return;
  if (closes(view, limits, spot, node, before, places)) {
    best_ = before - 2.0 * node.rate / node.slope;
    last_ = node;
    last_step_ = step_;
    found_ = true;
    return;
  }
  std::size_t at = next_count_++;
  for (; at > 0 && next_[at - 1].score > node.score; --at) next_[at] = next_[at - 1];
  next_[at] = node;
}

void StopSearch::keep(const Node& node) noexcept {
  steps_[step_][count_] = {node.bends, node.parent};
  now_[count_++] = node;
}

/// The better half of the width, and others of all scores; of twins one. False: none is left that may rest
/// sooner.
bool StopSearch::next_step() noexcept {
  constexpr double kSameRate = 0.01;
  const double same_slope = 0.1 / (kPieces * piece_ * 40.0);
  std::size_t distinct = 0;
  for (std::size_t n = 0; n < next_count_; ++n) {
    bool twin = false;
    for (std::size_t k = 0; k < distinct && !twin; ++k)
      twin = std::abs(next_[k].rate - next_[n].rate) < kSameRate &&
             std::abs(next_[k].slope - next_[n].slope) < same_slope;
    if (!twin) next_[distinct++] = next_[n];
  }
  count_ = 0;
  const std::size_t first = distinct <= kWidth ? distinct : (kWidth + 1) / 2,
                    spread = kWidth - (kWidth + 1) / 2;
  for (std::size_t n = 0; n < first; ++n) keep(next_[n]);
  if (first < distinct)
    for (std::size_t n = 0; n < spread; ++n) keep(next_[first + n * (distinct - first) / spread]);
  node_ = option_ = next_count_ = 0;
  ++step_;
  return count_ > 0 && step_ < kMostSteps && static_cast<double>(step_ * kPieces) * piece_ < best_;
}

void StopSearch::make_plan() noexcept {
  std::array<const Bends*, kMostSteps> bends{};
  bends[last_step_] = &last_.bends;
  std::size_t node = last_.parent;
  for (std::size_t n = last_step_; n > 0; --n) {
    bends[n - 1] = &steps_[n - 1][node].bends;
    node = steps_[n - 1][node].parent;
  }
  StopPlan plan;
  plan.begin(from_.rate, from_.slope, piece_);
  for (std::size_t n = 0; n <= last_step_; ++n)
    for (const double bend : *bends[n]) plan.add(sense_ * bend);
  plan.close();
  verification_.begin(plan, from_.time, from_.knot);
  verifying_ = true;
}

Fit StopSearch::go(const CourseView& view, const RateLimits& limits, bool conclude, int& places) noexcept {
  while (!verifying_) {
    if (places <= 0 && !conclude) return Fit::open;
    bool goes_on = !conclude;
    if (goes_on && node_ < count_) {
      expand(view, limits, places);
      if (++option_ == kOptions) {
        option_ = 0;
        ++node_;
      }
      continue;
    }
    if (goes_on) goes_on = next_step();
    if (goes_on) continue;
    if (!found_) return Fit::breaks;
    make_plan();
  }
  return verification_.go(view, limits, places);
}

}  // namespace servogate::path
