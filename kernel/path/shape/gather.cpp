// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/gather.hpp"

#include <algorithm>
#include <numbers>

namespace servogate::path {
namespace {

constexpr double kUsual = 0.01;  // mm: what the clock of a run without corners is made for

}  // namespace

void Gather::restart(const Vector& at) {
  at_ = at;
  open_ = false;
  flaw_ = Flaw::none;
}

bool Gather::goes_on(const Element& e) const {
  const Transition& t = e.transition;
  return e.kind != Element::Kind::rapid && t.continuation != Continuation::exact_stop && t.tolerance > 0.0 &&
         (t.continuation != Continuation::corner_limited || t.erf > 0.0);
}

bool Gather::stops_before(const Element& e, const Piece& piece) const {
  if (e.kind == Element::Kind::rapid) return true;
  return before_.continuation == Continuation::corner_limited &&
         turn(last_, piece, config_.axis_count) > before_.max_angle_deg / 180.0 * std::numbers::pi + 1e-9;
}

bool Gather::add(const Element& e) {
  const Shaped shaped = shape(config_, at_, e);
  flaw_ = shaped.flaw;
  if (flaw_ != Flaw::none) return false;
  const bool moves = shaped.piece.length > 0.0;
  if (open_ && moves && stops_before(e, shaped.piece)) rest(false);
  if (moves) {
    put(e, shaped.piece);
    at_ = e.to;
  }
  if (!goes_on(e)) rest(e.transition.confirm && e.transition.continuation == Continuation::exact_stop);
  return true;
}

void Gather::put(const Element& e, const Piece& piece) {
  Leg leg;
  leg.piece = piece;
  if (e.kind != Element::Kind::rapid) leg.feed = e.feed;
  leg.limits = &config_.limits;
  leg.turning = true;
  for (int i = 0; i < config_.axis_count; ++i)
    if (!config_.rotary[static_cast<std::size_t>(i)] &&
        (at_[i] != e.to[i] || piece.shape == Piece::Shape::arc))
      leg.turning = false;
  const double own = goes_on(e) ? e.transition.tolerance : 0.0, begin = open_ ? before_.tolerance : 0.0;
  leg.exact = own == 0.0 && begin == 0.0;
  leg.tolerance = leg.exact ? kUsual : own == 0.0 ? begin : begin == 0.0 ? own : std::min(own, begin);
  sink_.put(leg);
  open_ = true;
  before_ = e.transition;
  last_ = piece;
}

void Gather::rest(bool confirm) {
  if (open_) sink_.rest(confirm);
  open_ = false;
}

}  // namespace servogate::path
