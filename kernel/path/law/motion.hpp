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
/// The same of the terms of a span. real-time safe.
inline double spindle_share(const Terms& terms, double spindle) noexcept {
  return spindle_share(terms.feed, spindle);
}
/// The span is driven by the spindle's speed (feed per revolution). real-time safe.
inline bool follows_spindle(const Terms& terms) noexcept { return terms.feed.per_turn > 0.0; }

/// The law inside the cycle: owns place, speed and acceleration within the span in motion, and is the only
/// one to know how they go on. It drives by the terms of the spans, and has the branch for what they did not
/// foresee: hold, an override, another speed of the spindle, planning that is late. `ahead` begins with the
/// span in motion. All functions but the constructor are real-time safe.
class Motion {
 public:
  explicit Motion(const Config& config) : largest_override_(config.largest_override) {}

  /// Takes up the span in motion at its start, from rest.
  void begin(const Ahead& ahead, const Wish& wish) noexcept;
  /// Goes on in the span that is now in motion, behind one of `length`.
  void pass(double length, const Ahead& ahead, const Wish& wish) noexcept;
  /// At rest, with no span in motion.
  void rest() noexcept;

  /// The terms of the span in motion, or the wish, are no longer what they were.
  void renew() noexcept { stale_ = true; }
  /// Once a cycle, before advance(): follows the wish.
  void obey(const Ahead& ahead, const Wish& wish) noexcept;
  /// Goes on by `left` seconds, or to the end of the span in motion: then true, and `left` is what remains.
  bool advance(double& left, const Ahead& ahead) noexcept;

  const MotionState& state() const noexcept { return state_; }
  /// Neither speed nor acceleration is present.
  bool at_rest() const noexcept { return state_.v == 0.0 && state_.a == 0.0; }

 private:
  bool replan(const Ahead& ahead, const Wish& wish) noexcept;
  bool bridge(const Ahead& ahead) noexcept;
  bool bridge_clears(const Ahead& ahead, const Profile& way, int spans, const Box& least) const noexcept;

  double largest_override_;
  MotionState state_;    ///< within the span
  double length_ = 0.0;  ///< of the span
  Profile profile_;
  double clock_ = 0.0;     ///< time within the profile
  bool bridging_ = false;  ///< the profile leads to rest across spans, with acceleration at their ends
  double base_ = 0.0;      ///< place of the present span's start in the profile's coordinate
  bool stale_ = false;     ///< the profile wants planning anew
  bool resting_ = false;   ///< what the profile was planned for
};

/// How long the path takes at override 1, with the spindle turning as planned, span by span.
class Timing {
 public:
  /// Seconds from the start of `span`, reached as the one before was left, to its end. `behind`: the next
  /// one; nullptr where the path rests.
  double through(const Span& span, const Span* behind);
  /// How it goes along the last span, from its start; no longer than nothing where there was no way.
  const Profile& profile() const { return profile_; }

 private:
  MotionState at_;
  Profile profile_;
};

}  // namespace servogate::path
