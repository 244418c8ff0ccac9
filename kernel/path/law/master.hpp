// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/image/time.hpp"

namespace servogate::path {

/// What is known of a spindle as the master of a path. Times are machine time, ns.
struct MasterReading {
  bool valid = false;              ///< an encoder gives it, counted from its zero mark
  bool ready = true;               ///< at speed: a motion may begin
  double ordered = 1.0;            ///< revolutions/s that it is told, without sign; 0: to stand
  std::int64_t turns = 0;          ///< whole revolutions since the zero mark, + clockwise
  double part = 0.0;               ///< of a revolution, 0 - 1
  image::Nanoseconds at_ns = 0;    ///< when the encoder stood there
  image::Nanoseconds acts_ns = 0;  ///< when the set-point of this cycle is where the axes are
  double braking = 0.0;            ///< revolutions/s2 with which the spindle is stopped and reversed
  bool by_setpoint = false;        ///< threads go by the commanded angle, which the spindle is held to
  /// Of one by its set-point: revolutions by which the commanded angle was ahead of the measured one at that
  /// time; none: it is not known.
  std::optional<double> setpoint_ahead;
};

/// Revolutions from the estimate's own zero (a whole number of them from the zero mark), speed, acceleration.
struct MasterState {
  double n = 0.0, w = 0.0, a = 0.0;  ///< 1, 1/s, 1/s2
};

/// Angle, speed and acceleration of a master from readings with rounding and noise, at any time near them: an
/// alpha-beta-gamma filter with fading memory over the times of the readings, whatever their age. A constant
/// acceleration leaves no error. All functions are real-time safe.
class MasterEstimate {
 public:
  /// 1/s: what it forgets. Slower takes out more of the rounding, faster follows a load sooner.
  static constexpr double kForgets = 60.0;
  /// Readings that come no more leave it unknown after so long.
  static constexpr double kPatience = 0.025;  // s

  /// The reading of this cycle; one with the time of the last is no news.
  void take(const MasterReading& reading) noexcept;
  /// Enough has been read, and readings come.
  bool known() const noexcept { return settled_ && !lost_; }
  MasterState at(image::Nanoseconds t_ns) const noexcept;
  /// Revolutions from the estimate's zero as the newest reading says, and its time.
  double read() const noexcept { return read_; }
  image::Nanoseconds read_at() const noexcept { return at_ns_; }
  /// A reading came in this cycle.
  bool fresh() const noexcept { return fresh_; }

 private:
  void begin(const MasterReading& reading) noexcept;

  MasterState state_;  ///< at at_ns_
  std::int64_t zero_ = 0;
  image::Nanoseconds at_ns_ = 0, begun_ns_ = 0, acts_ns_ = 0, fresh_ns_ = 0;
  double read_ = 0.0;
  bool begun_ = false, moves_ = false, settled_ = false, lost_ = true, fresh_ = false;
};

/// Revolutions/s: slower is rest.
inline constexpr double kMasterStands = 0.05;
/// 1/s: how fast a set-point settles on its master. Jerk that takes error, speed and acceleration to zero.
inline constexpr double kMasterSettles = 60.0;
constexpr double settling_jerk(double s, double v, double a) noexcept {
  constexpr double k = kMasterSettles;
  return k * k * k * s + 3.0 * k * k * v + 3.0 * k * a;
}

/// A master as its readings are, for the bound of the phase error.
struct MasterQuality {
  double period_s = 0.001;
  double dead_time_s = 0.001;  ///< from a reading's time until the set-point reckoned from it acts
  double counts = 4096.0;      ///< of a revolution
  double noise_counts = 1.0;   ///< the most that a reading is off, rounding included
  double acceleration = 0.0;   ///< the most that the spindle is accelerated, revolutions/s2
};

/// The most that a set-point of `per_turn` mm a revolution is off its master's true angle, mm, while the
/// axes' limits do not bind: the sums of the responses to an acceleration and to an error of reading, each
/// taken at its worst. Not real-time safe: some thousand steps of the filter.
double phase_bound(const MasterQuality& quality, double per_turn);

}  // namespace servogate::path
