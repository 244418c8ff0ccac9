// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/s_curve.hpp"
#include "kernel/path/law/span.hpp"

namespace servogate::path {

/// What the cycle wants of the motion now.
struct Wish {
  bool rest = false;            ///< as soon as possible
  double override_ratio = 1.0;  ///< > 0 unless rest
  double spindle = -1.0;        ///< revolutions a second, below 0: as planned
};

/// Share of the speed that a span is planned for, by the spindle alone. real-time safe.
inline double spindle_share(const Feed& feed, double spindle) noexcept {
  return feed.per_turn > 0.0 && spindle >= 0.0 ? spindle / feed.turns : 1.0;
}

/// The law inside the cycle for a span from rest to rest: owns place, speed and acceleration, and is the only
/// one to know how they go on. The way off the law, for a hold, an override or another speed of the spindle,
/// is an S-curve of the same kind from the present state. All functions are real-time safe.
class Motion {
 public:
  /// Takes up a span at its start, from rest.
  void begin(const Span& span, const Wish& wish) noexcept;
  /// At rest, with no span in motion.
  void rest() noexcept { state_ = {}; }
  /// The wish is no longer what it was.
  void renew() noexcept { stale_ = true; }
  /// Once a cycle, before advance(): follows the wish along the span in motion.
  void obey(const Span& span, const Wish& wish) noexcept;
  /// Goes on by `seconds`. True: it is at rest in the end of the span.
  bool advance(double seconds) noexcept;

  const MotionState& state() const noexcept { return state_; }
  /// Neither speed nor acceleration is present.
  bool at_rest() const noexcept { return state_.v == 0.0 && state_.a == 0.0; }

 private:
  bool replan(const Span& span, const Wish& wish) noexcept;

  MotionState state_;    ///< within the span
  double length_ = 0.0;  ///< of the span
  Profile profile_;
  double clock_ = 0.0;    ///< time within the profile
  bool stale_ = false;    ///< the profile wants planning anew
  bool resting_ = false;  ///< what the profile was planned for
};

/// How a span from rest to rest is driven at override 1, with the spindle turning as planned.
Profile as_planned(const Span& span);

}  // namespace servogate::path
