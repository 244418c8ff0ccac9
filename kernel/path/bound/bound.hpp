// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// What the parameter may do on a piece: anything with 0 <= velocity <= V, |acceleration| <= A and |jerk| <=
/// J keeps every axis inside its limits.
struct Box {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
};

/// How fast the program wants a piece driven, as parameter speed.
struct Feed {
  double speed = 0.0;     ///< at override 1, with the spindle turning as planned; within the box
  double per_turn = 0.0;  ///< in one revolution of the spindle, 0: feed per time
  double turns = 0.0;     ///< revolutions a second that `speed` is planned for
  Lock lock{};            ///< by the angle of the spindle, from the begin of the piece on
  bool rapid = false;     ///< follows the override up to 1 only
};

/// What a place of the path allows.
struct Bound {
  Box box;
  Feed feed;
};

/// The box of a piece whose speed will not exceed `velocity_cap` (infinite: as fast as the limits).
Box box(const Config& config, const Piece& piece, double velocity_cap);

/// Box and feed of a piece that is driven as `element` says.
Bound bound(const Config& config, const Piece& piece, const Element& element);

}  // namespace servogate::path
