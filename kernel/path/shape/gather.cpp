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

/// While a path speeds up from rest the spindle slows down more than along the same way at its feed.
void slow_down_from_rest(Leg& leg) {
  Surface& surface = leg.surface;
  if (!(surface.late > 0.0) || surface.late_from > 0.0) return;
  const double turns = std::sqrt(surface.late), per_turn = leg.feed / leg.revolutions;
  constexpr double kAsked = 1.01, kWhileMoving = 0.3;  // of the turns; of the time to speed up
  double a = kNone, j = kNone;
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    if (!moves(leg, i)) continue;
    a = std::min(a, (*leg.limits)[i].acceleration);
    j = std::min(j, (*leg.limits)[i].jerk);
  }
  // It begins to slow down when it is asked to, that is where the path moves already.
  Surface asked = surface;
  asked.late = 0.0;
  const double begun = turns_at(asked, evaluate(leg.piece, 0.0, kMaxAxes).x, 0.0);
  const double share = turns > kAsked * begun ? 0.5 : kWhileMoving;
  const double v = per_turn * turns, seconds = v > a * a / j ? v / a + a / j : 2.0 * std::sqrt(v / j);
  const double left = std::max(0.0, turns - 0.5 * surface.late_fall * per_turn * share * seconds);
  surface.late = left * left;
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
    leg.revolutions = std::max(e.surface.most, std::sqrt(e.surface.late));
    leg.feed *= leg.revolutions / e.revolutions;
  }
  leg.limits = &config_.limits;
  if (!open_) slow_down_from_rest(leg);
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

/// Constant speed of the parameter that is surely kept along a leg, and how long its ends are at least that
/// come to it from rest. 0: there is none.
double Gather::cruise_speed(const Leg& leg, double& end) const {
  // Shares of feed and limits that are surely reached; how much longer than the way to speed up the ends are.
  constexpr double kFeed = 0.999, kVelocity = 0.98, kShare = 0.95, kLonger = 1.15, kMoreSeconds = 0.03;
  constexpr double kBeside = 0.01;  // of the limits, beside the reserve
  constexpr double kCorner = 0.25, kCornerByTolerance = 10.0;
  constexpr double kTurning = 0.25, kTurningJerk = 0.1;  // of the limits: what needs more is planned
  const double left = 1.0 - config_.reserve;
  const double velocity = std::min(kVelocity, left - kBeside), share = std::min(kShare, left - 4.0 * kBeside);
  const Piece& p = leg.piece;
  const bool arc = p.shape == Piece::Shape::arc;
  const auto turned = [&](std::size_t coordinate) {
    Vector unit{};
    unit[coordinate] = 1.0;
    return turned_to_axes(*config_.transformation, unit, config_.axis_count);
  };
  const Vector straight = turned_to_axes(*config_.transformation, p.c1, config_.axis_count);
  const Vector plane1 = arc ? turned(p.axis1) : Vector{}, plane2 = arc ? turned(p.axis2) : Vector{};
  const double most = std::max(p.radius, p.radius + p.radius_slope * p.length), omega = std::abs(p.omega);
  double v = kFeed * leg.feed, a = kNone, j = kNone;
  for (std::size_t i = 0; i < static_cast<std::size_t>(config_.axis_count); ++i) {
    const AxisLimits& limits = (*leg.limits)[i];
    const double round = arc ? most * omega * std::hypot(plane1[i], plane2[i]) : 0.0;
    const double rate = std::abs(straight[i]) + round;
    if (rate == 0.0) continue;
    v = std::min(v, velocity * limits.velocity / rate);
    a = std::min(a, (share - (arc ? kTurning : 0.0)) * limits.acceleration / rate);
    j = std::min(j, (share - (arc ? kTurningJerk : 0.0)) * limits.jerk / rate);
    if (v * v * omega * round > kTurning * limits.acceleration ||
        v * v * v * omega * omega * round > kTurningJerk * limits.jerk)
      return 0.0;
  }
  // Where an axis is too slow for the feed, it is so in some directions of an arc alone.
  if (arc && v < kFeed * leg.feed) return 0.0;
  const double seconds = v >= a * a / j ? v / a + a / j : 2.0 * std::sqrt(v / j);
  // The estimate of a clock speeds up in its own way.
  const double clock = std::sqrt(2.0) / 3.0 * v * std::sqrt(v / j) + v * v / (1.4 * a);
  end = kLonger * std::max(0.5 * v * seconds, clock) + kMoreSeconds * v + kCorner +
        kCornerByTolerance * leg.tolerance;
  return v;
}

/// The middle of a long line or arc is driven at its feed: a run before it and one behind it are left to
/// plan.
bool Gather::put_with_cruise(const Leg& leg) {
  constexpr double kLeastGain = 0.08;  // s
  constexpr double kHardly = 1.001;    // faster than the middle, beside it: the first clock steps no higher
  const bool arc = leg.piece.shape == Piece::Shape::arc;
  if (leg.surface.speed > 0.0 && (arc || leg.piece.c1[leg.surface.axis] != 0.0 || leg.surface.late > 0.0))
    return false;  // no constant speed
  double end = 0.0;
  const double v = cruise_speed(leg, end), middle = leg.piece.length - 2.0 * end;
  if (!(middle > kLeastGain * v) || v == 0.0) return false;
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
