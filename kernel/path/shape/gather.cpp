// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/gather.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kSlowestCorner = 0.5;                         // mm/s; slower is rest
constexpr double kWayBack = 179.5 / 180.0 * std::numbers::pi;  // rad
constexpr double kMostBulge = 0.25;                            // of the tolerance
constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kUsual = 0.01;  // mm: what the clock of a run without corners is made for

/// NC-110 G27: the speed at which the corner's form error is what the program allows.
double corner_speed(const Config& config, const Transition& transition, const Piece& before,
                    const Piece& next) {
  if (transition.continuation != Continuation::corner_limited) return kNone;
  const double s = std::cos(0.5 * turn(before, next, config.axis_count));
  if (s >= 1.0) return kNone;
  double a = kNone;
  const auto direction = [&](const Piece& piece, double place) {
    return turned_to_axes(*config.transformation, evaluate(piece, place, config.axis_count).d1,
                          config.axis_count);
  };
  const Vector t0 = direction(before, before.length), t1 = direction(next, 0.0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(config.axis_count); ++i)
    if (std::abs(t0[i]) + std::abs(t1[i]) > 1e-9) a = std::min(a, config.limits[i].acceleration);
  return std::sqrt(a * transition.erf * s / (1.0 - s));
}

}  // namespace

void Gather::restart(const Vector& at) {
  at_ = at;
  open_ = false;
  flaw_ = Flaw::none;
}

bool goes_on(const Element& e) {
  const Transition& t = e.transition;
  return e.kind != Element::Kind::rapid && t.continuation != Continuation::exact_stop && t.tolerance > 0.0 &&
         (t.continuation != Continuation::corner_limited || t.erf > 0.0);
}

bool rests_between(const Config& config, const Transition& transition, const Piece& before,
                   const Element& element, const Piece& piece) {
  if (element.kind == Element::Kind::rapid) return true;
  const double angle = turn(before, piece, config.axis_count);
  // A way back on itself reaches its end point.
  if (angle > kWayBack && std::min(before.length, piece.length) > transition.tolerance) return true;
  return transition.continuation == Continuation::corner_limited &&
         (angle > transition.max_angle_deg / 180.0 * std::numbers::pi + 1e-9 ||
          corner_speed(config, transition, before, piece) < kSlowestCorner);
}

bool Gather::add(const Element& e) {
  const Shaped shaped = shape(config_, at_, e);
  flaw_ = shaped.flaw;
  if (flaw_ != Flaw::none) return false;
  const bool moves = shaped.piece.length > 0.0;
  if (moves && rests_before(e, shaped.piece)) rest(false);
  if (moves) {
    put(e, shaped.piece);
    at_ = e.to;
  }
  if (!goes_on(e)) rest(e.transition.confirm && e.transition.continuation == Continuation::exact_stop);
  return true;
}

/// So far a curve is from the chord between its places in two cycles.
double Gather::bulge() const {
  double square = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(config_.axis_count); ++i)
    square += config_.limits[i].acceleration * config_.limits[i].acceleration;
  return config_.period_s * config_.period_s * std::sqrt(square) / 8.0;
}

void Gather::put(const Element& e, const Piece& piece) {
  Leg leg;
  leg.piece = piece;
  if (e.kind != Element::Kind::rapid) {
    leg.feed = e.feed;
    leg.revolutions = e.revolutions;
  }
  if (e.revolutions > 0.0 && e.surface.speed > 0.0) {
    leg.surface = e.surface;
    leg.revolutions = e.surface.most;
    leg.feed *= e.surface.most / e.revolutions;
  }
  leg.limits = &config_.limits;
  leg.axes = axes_moved(config_, piece);
  if (open_) leg.corner = corner_speed(config_, before_, last_, piece);
  const double own = goes_on(e) ? e.transition.tolerance : 0.0, begin = open_ ? before_.tolerance : 0.0;
  leg.exact = own == 0.0 && begin == 0.0;
  leg.tolerance = leg.exact ? kUsual : own == 0.0 ? begin : begin == 0.0 ? own : std::min(own, begin);
  leg.tolerance -= std::min(kMostBulge * leg.tolerance, bulge());
  // From rest to rest there is nothing to round.
  const bool single = !open_ && !goes_on(e);
  if (single || !put_with_cruise(leg)) sink_.put(leg);
  open_ = true;
  before_ = e.transition;
  last_ = piece;
}

/// The middle of a long line is driven at its feed: a run before it and one behind it are left to plan.
bool Gather::put_with_cruise(const Leg& leg) {
  // Shares of feed and limits that are surely reached; how much longer than the way to speed up the ends are.
  constexpr double kFeed = 0.999, kVelocity = 0.98, kShare = 0.95, kLonger = 1.3, kMoreSeconds = 0.08;
  constexpr double kBeside = 0.01;  // of the limits, beside the reserve
  constexpr double kCorner = 1.0, kCornerByTolerance = 40.0, kLeastGain = 0.15;
  constexpr double kHardly = 1.001;  // faster than the middle, beside it: the first clock steps no higher
  if (leg.piece.shape != Piece::Shape::line) return false;
  if (leg.surface.speed > 0.0 && leg.piece.c1[leg.surface.axis] != 0.0) return false;  // no constant speed
  const double left = 1.0 - config_.reserve;
  const double velocity = std::min(kVelocity, left - kBeside), share = std::min(kShare, left - 4.0 * kBeside);
  const Vector along = turned_to_axes(*config_.transformation, leg.piece.c1, config_.axis_count);
  double v = kFeed * leg.feed, a = std::numeric_limits<double>::infinity(), j = a;
  for (std::size_t i = 0; i < static_cast<std::size_t>(config_.axis_count); ++i) {
    const double rate = std::abs(along[i]);
    if (rate == 0.0) continue;
    v = std::min(v, velocity * (*leg.limits)[i].velocity / rate);
    a = std::min(a, share * (*leg.limits)[i].acceleration / rate);
    j = std::min(j, share * (*leg.limits)[i].jerk / rate);
  }
  const double seconds = v >= a * a / j ? v / a + a / j : 2.0 * std::sqrt(v / j);
  // The estimate of a clock speeds up in its own way.
  const double clock = std::sqrt(2.0) / 3.0 * v * std::sqrt(v / j) + v * v / (1.4 * a);
  const double end = kLonger * std::max(0.5 * v * seconds, clock) + kMoreSeconds * v + kCorner +
                     kCornerByTolerance * leg.tolerance;
  const double middle = leg.piece.length - 2.0 * end;
  if (!(middle > kLeastGain * v)) return false;
  Leg some = leg;
  some.feed = std::min(leg.feed, kHardly * v);
  some.piece = part(leg.piece, 0.0, end);
  sink_.put(some);
  some.corner = kNone;
  some.piece = part(leg.piece, end, middle);
  sink_.cruise(some, v);
  some.piece = part(leg.piece, end + middle, end);
  sink_.put(some);
  return true;
}

void Gather::rest(bool confirm) {
  if (open_) sink_.rest(confirm);
  open_ = false;
}

}  // namespace servogate::path
