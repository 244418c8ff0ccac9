// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/alarm.hpp"
#include "kernel/axis/config/axis_config.hpp"
#include "kernel/axis/homing/drive_led_homing.hpp"
#include "kernel/axis/homing/switch_edge.hpp"
#include "kernel/axis/setpoint/ramp.hpp"

namespace servogate::axis {

/// What homing sees of its axis in one cycle.
struct HomingInputs {
  double dt = 0.001;
  image::Nanoseconds now_ns = 0;
  bool home_switch = false;
  bool limit_plus = false;
  bool limit_minus = false;
  bool settled = false;     ///< set-point at rest and the feedback caught up with it
  bool referenced = false;  ///< a kept reference is in force (absolute encoder)
  std::int64_t counts = 0;  ///< measured, drive counts
  std::int64_t latch_counts = 0;
  std::uint32_t latch_sequence = 0;
  DriveLedInputs drive;          ///< method drive
  std::int64_t home_counts = 0;  ///< that the drive found
};

/// Homing of one axis (methods of HomingData). It only moves a Ramp and arms the drive's latch; the axis sets
/// its machine position when told to. A hard limit in the way of the search reverses it once. By method
/// `drive` it moves nothing: see DriveLedHoming.
class Homing {
 public:
  enum class State : std::uint8_t {
    idle,
    search,      ///< fast, towards the switch
    reversed,    ///< fast, back from a hard limit, towards the switch
    back_off,    ///< off the switch, against the direction of search
    approach,    ///< slowly onto the switch
    leave,       ///< slowly off the switch, the decisive edge being the release
    index,       ///< latch armed, slowly to the zero mark
    drive_led,   ///< the drive homes
    settle,      ///< captured: stopping
    final_move,  ///< machine position set, to the final position
    done,
    failed,
  };

  void configure(const HomingData& data, const MotionLimits& limits) noexcept;
  /// Begins. real-time safe.
  void start(const Ramp& ramp, const HomingInputs& in) noexcept;
  /// One cycle: may give the ramp a new target. Call before Ramp::step. real-time safe.
  void step(Ramp& ramp, const HomingInputs& in) noexcept;
  /// What edges of the home switch and positions have come, before step(); see SwitchEdge. Of a machine whose
  /// switch tells its edges (HomingData::edges) the decisive edge is met by them. real-time safe.
  void switch_edge(bool level, image::Nanoseconds t) noexcept { edge_.edge(level, t); }
  void sample(image::Nanoseconds t, std::int64_t counts) noexcept { edge_.sample(t, counts); }
  /// Of the last homing: its switch was met by the level although it should tell its edges.
  bool missed_edge() const noexcept { return missed_edge_; }
  /// Gives up and stops the ramp; no failure is recorded. real-time safe.
  void abort(Ramp& ramp) noexcept;

  /// The drive does not hold the axis any more. Gives up without a stop. real-time safe.
  void drop() noexcept;

  State state() const noexcept { return state_; }
  bool active() const noexcept { return state_ != State::idle && state_ < State::done; }
  /// The drive leads the axis: under way, or being brought to rest and back after homing was given up.
  bool drive_leads() const noexcept { return drive_.leads(); }
  const DriveLedHoming& drive_led() const noexcept { return drive_; }
  /// One cycle of a drive that is being brought back after homing was given up. real-time safe.
  void bring_back(const HomingInputs& in) noexcept { drive_.step(data_, in.drive); }
  /// The drive's latch is to be armed (zero mark). real-time safe.
  bool latch_arm() const noexcept { return state_ == State::index && !stopping_; }
  /// True once, in the cycle in which the axis has to set `captured_counts()` = home position. real-time
  /// safe.
  bool take_reference() noexcept;
  std::int64_t captured_counts() const noexcept { return captured_; }
  /// Way from the decisive edge to the zero mark in counts; near 0 or near a whole revolution the next homing
  /// may take the neighbouring mark.
  std::int64_t index_distance_counts() const noexcept { return captured_ - edge_counts_; }
  /// Alarm number of the failure, 0: none; limit and value for its text.
  image::AlarmNumber failure() const noexcept { return failure_; }
  double failure_limit() const noexcept { return failure_limit_; }
  double failure_value() const noexcept { return failure_value_; }

 private:
  void enter(State s, Ramp& ramp) noexcept;
  void fail(image::AlarmNumber number, double limit, double value, Ramp& ramp) noexcept;
  bool stop_first(Ramp& ramp, const HomingInputs& in) noexcept;
  static bool limit_ahead(int direction, const HomingInputs& in) noexcept;
  void run(int direction, double speed, Ramp& ramp) noexcept;
  void search(Ramp& ramp, const HomingInputs& in) noexcept;
  void back_off(Ramp& ramp, const HomingInputs& in) noexcept;
  void approach(Ramp& ramp, const HomingInputs& in) noexcept;
  void leave(Ramp& ramp, const HomingInputs& in) noexcept;
  void index(Ramp& ramp, const HomingInputs& in) noexcept;
  void drive_led(Ramp& ramp, const HomingInputs& in) noexcept;
  void final_move(Ramp& ramp, const HomingInputs& in) noexcept;
  void after_switch_search(Ramp& ramp, const HomingInputs& in) noexcept;
  void decisive_edge(Ramp& ramp, const HomingInputs& in) noexcept;
  void meet_edge() noexcept;
  bool travel_exceeded(Ramp& ramp, double limit, image::AlarmNumber number) noexcept;

  HomingData data_;
  MotionLimits limits_;
  State state_ = State::idle;
  DriveLedHoming drive_;
  SwitchEdge edge_;
  bool missed_edge_ = false;
  bool stopping_ = false;  ///< the condition of the state is met, the ramp comes to rest
  bool seen_on_ = false;
  bool limit_met_ = false;
  bool reference_pending_ = false;
  int moving_ = 0;  ///< direction of the present move
  double begin_x_ = 0.0;
  double elapsed_s_ = 0.0;
  std::int64_t captured_ = 0;
  std::int64_t edge_counts_ = 0;
  std::uint32_t armed_sequence_ = 0;
  image::AlarmNumber failure_ = 0;
  double failure_limit_ = 0.0;
  double failure_value_ = 0.0;
};

}  // namespace servogate::axis
