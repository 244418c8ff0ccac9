// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/path/law/master.hpp"

namespace servogate::axis {

/// What is asked of two spindles, or of an axis and its master. A turn of a linear axis is a millimetre.
struct CouplingOrder {
  std::int64_t leader_turns = 1;    ///< for so many turns of the leader, >= 1 ...
  std::int64_t follower_turns = 1;  ///< ... the follower makes these, not 0; below 0 it turns the other way
  double phase_deg = 0.0;           ///< 360th of a turn of the follower where the leader is at its zero
};

/// What comes round to the same place: a spindle and an endless axis in a turn, an axis with a travel never.
enum class ComesRound : std::uint8_t { neither, leader, follower, both };

/// Where a follower is led to, in its own revolutions, and how fast.
struct Led {
  bool known = false;
  double turns = 0.0;  ///< that the position loop holds it to, at its newest reading; while `known`
  double seen = 0.0;   ///< the same by the leader's measured angle: the phase error counts from there
  double rpm = 0.0;    ///< at which the leader has it turn from the next SYNC on
};

/// The link of a spindle or an axis that follows another one. The leader's angle counts from its zero, and so
/// does the follower's. Where they come round several places of the follower are equal (of two spindles where
/// the ratio is no whole number), and the nearest one is taken when its speed is reached. All functions are
/// real-time safe.
class Coupling {
 public:
  void begin(const CouplingOrder& order, ComesRound round = ComesRound::both) noexcept;
  void end() noexcept { on_ = placed_ = synchronous_ = false; }
  bool on() const noexcept { return on_; }
  /// Turns of the follower for one of the leader, with its sign.
  double ratio() const noexcept { return ratio_; }
  /// The place has been chosen: what follows is held to it.
  bool placed() const noexcept { return placed_; }
  bool synchronous() const noexcept { return synchronous_; }
  /// The leader's measured angle, in each cycle in which it may be asked for.
  void look(const path::MasterReading& reading) noexcept { estimate_.take(reading); }
  const path::MasterEstimate& estimate() const noexcept { return estimate_; }

  /// The place of the follower for a leader's angle, revolutions; any of the equal ones until it is placed.
  double place(double leader_turns) const noexcept { return ratio_ * leader_turns + phase_ + shift_; }
  /// Chooses the place nearest to where the follower is, `behind` turns behind place().
  void choose(double behind) noexcept;
  /// How far that place is off, turns.
  double to_nearest(double behind) const noexcept;
  /// Takes the place where the follower is, whatever the phase.
  void capture(double behind) noexcept;
  /// The follower is so far behind its place, turns. True in the cycle in which it falls out of synchronism.
  bool watch(double behind, double window_deg, double dt) noexcept;
  /// The chosen place means nothing any more.
  void lose_place() noexcept { placed_ = synchronous_ = false; }

 private:
  bool on_ = false, placed_ = false, synchronous_ = false;
  double ratio_ = 1.0, phase_ = 0.0, shift_ = 0.0;
  double spacing_ = 1.0;  ///< turns of the follower from one equal place to the next; 0: there is one
  double inside_s_ = 0.0;
  path::MasterEstimate estimate_;
};

}  // namespace servogate::axis
