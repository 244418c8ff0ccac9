// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "kernel/path/law/master.hpp"
#include "kernel/path/law/s_curve.hpp"
#include "kernel/path/law/span.hpp"

namespace servogate::path {

/// Why a motion by the spindle's angle was left, or did not begin.
enum class MasterFault : std::uint8_t {
  none,
  lost,       ///< no reading, or no zero mark
  reversed,   ///< it stood or turned back; value: revolutions/s, limit: the least
  window,     ///< value: mm off the master, limit: Threads::window
  too_fast,   ///< value: mm/s that its speed asks for, limit: what the axes allow
  too_short,  ///< value: mm of path, limit: what speeding up and braking need
  stands,     ///< it is not told to turn, or not at its speed after s `value`, limit: s
  overshoot,  ///< a tap comes to rest `value` mm beyond its depth, limit: Threads::tap_overshoot
  no_turn,    ///< the spindle of a tap has neither stopped nor turned round after s `value`, limit: s
  starved,    ///< the rest of a chain of threads was not planned in time
};

/// The law inside the cycle for a run by the spindle's angle, from rest to rest: it is run in so that the
/// path is where the angle says from its lead-in on whatever the speed, then locked to the angle, and braked
/// into the end. Limits of path speed, acceleration and jerk are those of the run's tightest span and hold
/// whatever the master does. All functions but the constructor are real-time safe.
///
/// A thread may be a chain of any length: it begins when its end is known, or so much of it that the planner
/// waits for the motion, and takes up the rest as it goes. Box and leads are those of what is known.
///
/// A tap is legs on one line: to a depth, back, in again where chips are broken, out. At the end of each but
/// the last it has its spindle turn round, stand before where that is asked for, and goes with it whatever it
/// does, until the spindle stands or the depth would be exceeded by Threads::tap_overshoot.
class MasterMotion {
 public:
  static constexpr int kMostSpans = 128;  ///< known at a time, some of them behind the motion
  /// s at the limits of its spans: a path that is known so far begins before its end is known. The planner
  /// comes further than that before it waits for the motion.
  static constexpr double kKnownAhead = 1.9;
  static constexpr int kMostLegs = 64;  ///< of a tap
  explicit MasterMotion(const Config& config)
      : period_(config.period_s),
        window_(config.threads.window),
        tap_overshoot_(config.threads.tap_overshoot) {}

  /// Takes up the run that begins with the first span, at rest. False: too little of it is known yet.
  bool begin(const Ahead& ahead) noexcept;
  /// Takes up what has become known of a thread; in each cycle before step().
  void extend(const Ahead& ahead) noexcept;
  /// One cycle. `wait`: it does not begin. `leave`: it is given up: a thread slows down at once, a tap when
  /// the spindle stands.
  void step(const MasterEstimate& master, const MasterReading& reading, bool wait, bool leave) noexcept;

  /// Over the run; of a tap over its leg in motion.
  const MotionState& state() const noexcept { return state_; }
  /// The end of the run is known.
  bool ends() const noexcept { return ends_; }
  /// Tightest box of what is known of the run. What of it the path still needs when it slows down.
  const Box& box() const noexcept { return box_; }
  bool at_rest() const noexcept { return state_.v == 0.0 && state_.a == 0.0; }
  /// At rest in the end of the run.
  bool arrived() const noexcept { return phase_ == Phase::arrived; }
  /// Given up, and at rest or slowing down.
  bool leaving() const noexcept { return phase_ == Phase::leaving || phase_ == Phase::left; }
  bool left() const noexcept { return phase_ == Phase::left; }
  /// Locked to the angle, behind its lead-in.
  bool locked() const noexcept { return phase_ == Phase::locked && settled_; }
  bool taps() const noexcept { return lock_.kind != Lock::Kind::thread; }
  /// It goes by the commanded angle. A tap never does: its axis goes where the spindle goes, whatever that
  /// does.
  bool by_setpoint(const MasterReading& reading) const noexcept { return reading.by_setpoint && !taps(); }
  /// Leg of a tap in motion, from 0.
  int leg() const noexcept { return leg_; }
  /// The axes go where the spindle goes: a stop of theirs would part the tap from it. Bounded: the spindle
  /// stands in time, or the tap is given up.
  bool bound() const noexcept {
    return taps() && (phase_ == Phase::locked || (phase_ == Phase::leaving && fault_ == MasterFault::lost));
  }
  MasterFault fault() const noexcept { return fault_; }
  double value() const noexcept { return value_; }
  double limit() const noexcept { return limit_; }
  /// mm of path by which the set-point was off the measured angle of the same time, at the newest reading.
  double phase_error() const noexcept { return phase_error_; }
  /// How a tap wants its spindle to turn from here on, Lock::turn, and how fast; 0: as it does.
  int wants_turn() const noexcept { return asked_turn_; }
  double wants_rpm() const noexcept { return asked_rpm_; }
  /// It is to stand.
  bool wants_halt() const noexcept { return halt_ || turn_ == Turn::stopping || turn_ == Turn::standing; }
  /// mm by which a tap went beyond its depth; below 0: it has not reached it.
  double overshoot() const noexcept { return deepest_ - depth_; }

 private:
  enum class Phase : std::uint8_t { waiting, running_in, locked, braking, leaving, left, arrived };
  /// The end of a leg, and of a tap that is given up.
  enum class Turn : std::uint8_t { none, stopping, standing, turning, halting };
  struct Leg {
    double length = 0.0, per_turn = 0.0, velocity = 0.0;
    double dwell = 0.0, rpm = 0.0;
    int turn = 0;
  };
  struct Segment {
    double begin = 0.0, turns = 0.0;  ///< of its begin, along the run
    double per_turn = 0.0, change = 0.0, velocity = 0.0;
    double acceleration = 0.0, jerk = 0.0;
    double most = 0.0;  ///< mm of path in a revolution on it, those of its neighbours at their ends included
    double length = 0.0;
    double rise = 0.0, over = 0.0;  ///< of the lead at its begin, and revolutions that takes
  };

  bool gather_segments(const Ahead& ahead) noexcept;
  void take_spans(const Ahead& ahead) noexcept;
  void add_segment(const Span& span) noexcept;
  void drop_passed() noexcept;
  void reckon_box() noexcept;
  double end_lead(const Segment& g) const noexcept { return g.per_turn + g.change * turns_to(g, g.length); }
  void reset() noexcept;
  double progress(double n) const noexcept { return direction_ * (n - start_) - whole_; }
  struct Ideal {
    MotionState motion;
    double jerk = 0.0;
  };
  Ideal ideal(const MasterState& master) const noexcept;
  void smooth_lead(std::size_t n, double w) noexcept;
  double turns_to(const Segment& segment, double s) const noexcept;
  void try_begin(const MasterEstimate& master, const MasterReading& reading) noexcept;
  void follow(const MasterEstimate& master, const MasterReading& reading) noexcept;
  void watch(const MasterEstimate& master, const MasterReading& reading) noexcept;
  bool not_ready(const MasterEstimate& master, const MasterReading& reading) noexcept;
  // tap_motion.cpp
  bool gather_legs(const Ahead& ahead) noexcept;
  void begin_leg() noexcept;
  bool last_leg() const noexcept { return leg_ + 1 == legs_count_; }
  void tap(const MasterState& now, const MasterReading& reading) noexcept;
  void begin_turn(Turn turn, double w) noexcept;
  void turn_at_end(double w, const MasterReading& reading) noexcept;
  void watch_turn(double w, const MasterReading& reading) noexcept;
  void watch_depth() noexcept;
  double least_of_tap() const noexcept;
  void turn_back() noexcept;
  Box leaving_box(const MotionState& from) const noexcept;
  std::size_t segment_at(double s) const noexcept;
  bool too_fast(double w, double until) noexcept;
  double reach() const noexcept;
  double velocity_allowed() const noexcept;
  double within_limits(double jerk) const noexcept;
  void give_up() noexcept;
  void fail(MasterFault fault, double value, double limit) noexcept;
  void run_profile() noexcept;
  void remember(image::Nanoseconds acts_ns) noexcept;

  static constexpr int kHistory = 256;
  double period_, window_, tap_overshoot_;
  std::array<Segment, kMostSpans> segments_{};
  int count_ = 0;
  double length_ = 0.0;
  bool ends_ = false;        ///< the last segment is the end of the run
  std::uint64_t taken_ = 0;  ///< number of the span that is the last segment
  double known_s_ = 0.0;     ///< of the run, at the limits of its spans, behind its first span
  double first_time_ = 0.0;  ///< Span::time of the first
  Box box_;
  Lock lock_;
  MotionState state_;
  Phase phase_ = Phase::waiting;
  Profile profile_;
  double clock_ = 0.0, unknown_s_ = 0.0, not_ready_s_ = 0.0, locked_s_ = 0.0;
  double direction_ = 1.0, start_ = 0.0, whole_ = 0.0;
  double begun_with_ = 0.0;  ///< revolutions/s
  double fraction_ = -1.0;   ///< of a revolution behind the begin, one cycle ago
  bool settled_ = false, halt_ = false;
  MasterFault fault_ = MasterFault::none;
  double value_ = 0.0, limit_ = 0.0, phase_error_ = 0.0;

  std::array<Leg, kMostLegs> legs_{};
  int legs_count_ = 0, leg_ = 0;
  Turn turn_ = Turn::none;
  double turn_s_ = 0.0, turn_w_ = 0.0, stood_s_ = 0.0;  ///< since it was asked for, speed then; standing
  int asked_turn_ = 0;
  double asked_rpm_ = 0.0;
  double leg_begin_ = 0.0, sense_ = 1.0;    ///< of the leg in motion, along the way in
  double depth_ = 0.0, deepest_ = 0.0;      ///< along it: as programmed, and so far
  double braking_ = 0.0;                    ///< of the last reading
  std::array<double, kHistory> history_{};  ///< places, one a cycle
  int head_ = 0, remembered_ = 0;
  image::Nanoseconds newest_ns_ = 0;
};

}  // namespace servogate::path
