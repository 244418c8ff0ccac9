// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/alarms/axis_alarms.hpp"
#include "kernel/axis/config/axis_config.hpp"
#include "kernel/axis/control/compensation.hpp"
#include "kernel/axis/control/power_sequence.hpp"
#include "kernel/axis/homing/homing.hpp"
#include "kernel/axis/setpoint/ramp.hpp"
#include "kernel/axis/setpoint/scale.hpp"
#include "kernel/axis/torque/torque_control.hpp"

namespace servogate::axis {

/// The set-point of a process for one cycle, machine coordinates.
struct Setpoint {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double distance_to_go = 0.0;
  /// The axis goes with something that its stop would part it from: a tap in its hole with its spindle. A
  /// stop at the axis' own limits waits until the process rests; the process sees to it that it does.
  bool bound = false;
};

/// One axis: feedback to position, supervision, set-point of its owner, compensation, command to the drive.
///
/// In each cycle, in this order, everything real-time safe:
///   read(image)                 after the PLC scan: feedback, switches, K places
///   set_process(setpoint)       interpolation, where a process owns the axis
///   set_geared(state)           where its master has it, while it follows one
///   react(reaction)             the strongest reaction in force
///   command(image)              set-point, supervision, drive command, K places
/// Events found by read() and by command() stand in events() until clear_events() or the next read().
class Axis {
 public:
  /// Takes the configuration; `index` is the axis' place in the image. Not for the cycle (allocates).
  void configure(const AxisConfig& config, int index);
  const AxisConfig& config() const noexcept { return config_; }
  int index() const noexcept { return index_; }

  // -- phases of a cycle
  void read(image::ProcessImage& image) noexcept;
  /// The next read() comes so much later than a period after the one before. real-time safe.
  void note_late(double s) noexcept { late_s_ = s; }
  void set_process(const Setpoint& setpoint) noexcept;
  void react(image::Reaction reaction) noexcept { reaction_ = reaction; }
  void command(image::ProcessImage& image) noexcept;
  const Events& events() const noexcept { return events_; }
  void clear_events() noexcept { events_.clear(); }
  /// True while the cause of an alarm of this axis is still there: its reset condition is not met.
  bool present(image::AlarmNumber number) const noexcept;

  // -- owner
  /// Makes `owner` the one owner. False (nothing changed) unless the axis stands still or has that owner
  /// already.
  bool acquire(image::AxisOwner owner) noexcept;
  /// Gives the axis back. False when it is another's, or still moving; then it goes back as soon as it
  /// stands.
  bool release(image::AxisOwner owner) noexcept;
  image::AxisOwner owner() const noexcept { return owner_; }
  /// The process whose programs move it, and no other's. real-time safe.
  int process() const noexcept { return assigned_; }
  /// Its programs are those of another process from now on; at standstill, which the gate sees to. real-time
  /// safe.
  void assign(int process) noexcept { assigned_ = process; }

  // -- orders (after the gate); false when the axis may not move now or belongs to somebody else
  /// Operator's wish for drive power; in force while MC.power_on and <axis>.enable permit it. It falls by
  /// itself when the drive lets go, and with the reactions quick stop and power off: nothing comes on again
  /// unasked.
  void request_power(bool on) noexcept { power_requested_ = on; }
  bool power_requested() const noexcept { return power_requested_; }
  /// Moves on by `distance` from the target in force, at jog speed; clipped at the software limits.
  bool jog_increment(double distance) noexcept;
  /// Runs in `direction` (+1, -1) until jog_stop, a limit, or the keep-alive fails; `now` = time of the
  /// cycle.
  bool jog_continuous(int direction, image::Nanoseconds now) noexcept;
  void keep_alive(image::Nanoseconds now) noexcept { keep_alive_ns_ = now; }
  /// Machine seconds in a second of the wall clock, by which the hand of whoever jogs is judged. Before the
  /// first cycle.
  void set_time_scale(double scale) noexcept { time_scale_ = scale; }
  void jog_stop(image::JogEnd why = image::JogEnd::asked) noexcept;
  /// Direction of the continuous jog under way; 0: there is none.
  int jogs_on() const noexcept { return own_motion_ && manual_ == Manual::continuous ? jog_direction_ : 0; }
  /// A jog by increments is under way.
  bool increments() const noexcept { return own_motion_ && manual_ == Manual::increment; }
  /// What is left of it, with its sign.
  double way_left() const noexcept { return increments() ? ramp_.target() - set_.x : 0.0; }
  /// Speed of jogs at this moment: the slow one while not homed or on a limit switch.
  double jog_speed() const noexcept;
  /// Moves to a machine position at `velocity` (at most the limit), for manual, PLC or bench owners.
  bool move_to(double position, double velocity) noexcept;
  /// The PLC's motion of an auxiliary axis: to a machine position, with at most these limits. A motion of the
  /// PLC under way passes over into it. While feed_enable is FALSE the axis stands on its way and then goes
  /// on.
  bool plc_move_to(double position, MotionLimits limits) noexcept;
  /// The same in `direction` (+1, -1) at limits.velocity until it is stopped; a travel limit ends it.
  bool plc_move_at(int direction, MotionLimits limits) noexcept;
  /// Such a motion is under way, or held on its way.
  bool plc_moves() const noexcept { return own_motion_ && manual_ == Manual::plc; }
  /// Leads the auxiliary axis by torque, in per cent of the rated one with its sign, until another order of
  /// the PLC, a stop or a reaction; `ramp` in per cent a second, 0: the axis' own. Another torque takes over.
  bool plc_torque(double torque, double ramp, double velocity_limit) noexcept;
  /// Torque leads the axis, as it was asked for.
  bool torque_led() const noexcept { return own_motion_ && manual_ == Manual::torque; }
  /// The torque that was asked for is there: as set, and as the drive measures it.
  bool torque_reached() const noexcept;
  /// Measured, per cent of the rated torque, + towards rising positions; 0 where the drive does not tell.
  double torque_percent() const noexcept {
    return drive_.torque_known ? drive_.torque_permille / 10.0 * scale_.direction : 0.0;
  }
  /// Position, or speed with its sign, that the last one was to reach.
  double plc_goal() const noexcept { return goal_; }
  /// Starts homing (method of the configuration); the axis becomes the homing's own until it ends. False: it
  /// may not move, or moves. What homing lacks (the reference of an absolute encoder) is an alarm of its own.
  bool home() noexcept;
  /// Stops whatever this axis does by itself (jog, homing, following), at its limits.
  void stop() noexcept;
  /// The axis belongs to an electronic gear from now on. False: it may not move, moves, or is somebody
  /// else's.
  bool engage() noexcept;
  /// It does, or comes to rest behind it.
  bool geared() const noexcept { return owner_ == image::AxisOwner::gear; }
  /// It goes where set_geared() says.
  bool follows() const noexcept {
    return geared() && !own_motion_ && !stopped_by_reaction_ && reaction_ < image::Reaction::stop_axes;
  }
  /// Set-point of a cycle in which it follows(), inside its velocity, acceleration and jerk; one from which
  /// it could not stop inside its travel any more is an alarm, and the axis stops. real-time safe.
  void set_geared(const MotionState& state) noexcept { geared_ = state; }
  /// The window in which the axis counts as in position, mm or degrees, for as long as a program runs: at
  /// most following_error_limit of the configuration; 0: the configuration's own. real-time safe.
  void set_in_position_window(double window) noexcept;
  double in_position_window() const noexcept { return window_ > 0.0 ? window_ : config_.in_position_window; }
  /// Operator's reset: the drive's fault is reset, a reaction's stop is taken back.
  void reset() noexcept;

  // -- touch probe of the drive
  /// The drive latches its position at the next edge of one of its probe inputs (60B8h). real-time safe.
  void arm_probe(image::LatchSource source, bool negative_edge) noexcept;
  void disarm_probe() noexcept { probe_armed_ = false; }
  /// It has, since it was armed, and where; machine coordinate. real-time safe.
  bool probe_latched() const noexcept { return probe_armed_ && drive_.latch_sequence != probe_sequence_; }
  double probe_position() const noexcept;

  // -- reference
  /// Takes over a kept reference (state directory): these counts are the home position, the axis is homed.
  /// Only while the axis does not hold (before power). Methods absolute and none.
  void set_reference(std::int64_t reference_counts) noexcept;
  /// Counts at the home position, to be kept; meaningful while homed().
  std::int64_t reference_counts() const noexcept { return scale_.reference_counts; }
  bool homed() const noexcept { return homed_; }

  // -- the drive of a spindle
  /// Its drive is a spindle's (kernel/axis/spindle_axis.cpp): the axis neither judges nor commands it, and
  /// its set-point stays at `place`. Only without power. real-time safe.
  void sleep(double place) noexcept;
  /// It has its drive again: these counts are the home position. It powers it where power is asked for.
  void wake(std::int64_t reference_counts) noexcept;
  bool asleep() const noexcept { return asleep_; }
  /// Lets go of its drive, until the next wake(), whoever asks for power. real-time safe.
  void let_go() noexcept { lets_go_ = true; }

  // -- state for channel, gate, reports
  bool motion_permitted() const noexcept { return power_.motion_permitted() && !stopped_by_reaction_; }
  /// The set-point moves or a motion is under way.
  bool moving() const noexcept { return moving_; }
  /// Set-point at rest and measured speed below the standstill window.
  bool standstill() const noexcept { return !moving_ && actual_standing_; }
  bool in_position() const noexcept { return in_position_; }
  bool on_limit_plus() const noexcept { return limit_plus_; }
  bool on_limit_minus() const noexcept { return limit_minus_; }
  /// The axis took the motion away from its owner (reaction, limit, power); cleared by reset().
  bool stopped_by_reaction() const noexcept { return stopped_by_reaction_; }
  /// Power is to go and the axis still moves: its owner has to stop it.
  bool letting_go() const noexcept { return power_.state() == PowerSequence::State::stopping; }
  /// <axis>.feed_enable as the PLC wrote it.
  bool feed_enabled() const noexcept { return feed_enable_; }
  /// <axis>.enable and MC.power_on as the PLC wrote them.
  bool power_permitted() const noexcept { return power_permitted_; }
  /// Jog wish of the PLC: +1, -1 or 0 (both or none).
  int plc_jog() const noexcept { return plc_jog_; }
  const Homing& homing() const noexcept { return homing_; }
  const MotionState& setpoint() const noexcept { return set_; }
  double actual() const noexcept { return actual_; }
  double following_error() const noexcept { return following_error_; }
  PowerSequence::State power_state() const noexcept { return power_.state(); }
  const CountScale& scale() const noexcept { return scale_; }

 private:
  static constexpr int kHistory = 16;
  struct Sent {
    double command = 0.0, compensation = 0.0;
  };
  enum class Manual : std::uint8_t { rest, increment, continuous, position, plc, torque };

  // axis.cpp: the owner's set-point and the way to the drive
  void advance(double dt, image::Nanoseconds now) noexcept;
  void advance_process(double dt) noexcept;
  void advance_geared(double dt) noexcept;
  bool goes_with_master() const noexcept;
  void advance_own(double dt, image::Nanoseconds now) noexcept;
  void advance_homing(double dt) noexcept;
  void advance_manual(image::Nanoseconds now) noexcept;
  void advance_torque(double dt) noexcept;
  void follow_drive() noexcept;
  void check_index_place() noexcept;
  void break_homing(image::JogEnd why) noexcept;
  void take_away(image::JogEnd why = image::JogEnd::alarm) noexcept;
  void end_jog(image::JogEnd why) noexcept;
  void follow_feedback() noexcept;
  void set_machine_position(std::int64_t counts) noexcept;
  void drop_reference() noexcept;
  void fill_history(double step = 0.0) noexcept;
  void step_power(double dt, PowerSequence::Outputs& out) noexcept;
  void write_drive(image::ProcessImage& image, const PowerSequence::Outputs& power) const noexcept;
  void write_image(image::ProcessImage& image, const PowerSequence::Outputs& power) const noexcept;
  // axis_orders.cpp: jog, home, owner
  MotionLimits limits_with(double velocity) const noexcept;
  double clipped(double target) const noexcept;
  bool begin_own(image::AxisOwner owner) noexcept;
  bool begin_plc(double goal, MotionLimits limits, bool endless) noexcept;
  void advance_plc() noexcept;
  bool into_limit(double direction) const noexcept;
  HomingInputs homing_inputs(double dt) const noexcept;
  // axis_supervision.cpp: feedback, switches, limits
  static bool met(bool on, double& free_s, double dt) noexcept;
  void read_places(const image::ProcessImage& image) noexcept;
  void read_edges(const image::ProcessImage& image) noexcept;
  void read_feedback(const image::DriveFeedback& in, double dt) noexcept;
  void supervise_drive() noexcept;
  void supervise_position() noexcept;
  void warn_of_following_error() noexcept;
  void supervise_switches() noexcept;
  void supervise_setpoint() noexcept;
  bool leaves_travel(const MotionState& state, bool exactly = false) noexcept;
  void supervise_power(PowerSequence::State before) noexcept;
  void supervise_brake() noexcept;
  void supervise_path_end(double dt) noexcept;
  void report_path_end(double dt) noexcept;
  void update_in_position(double dt) noexcept;
  void raise(image::AlarmNumber number, double limit, double value, double d1 = 0.0,
             double d2 = 0.0) noexcept;
  const Sent& sent(int cycles_ago) const noexcept;

  AxisConfig config_;
  int index_ = 0;
  int assigned_ = 0;  ///< the process whose programs move it
  CountScale scale_;
  Compensation compensation_;
  PowerSequence power_;
  Homing homing_;
  TorqueControl torque_;
  Ramp ramp_;
  Events events_;
  std::array<image::AlarmNumber, 16> raised_{};  ///< since the last reset, so that each comes once
  int raised_count_ = 0;

  image::AxisOwner owner_ = image::AxisOwner::none;
  image::Reaction reaction_ = image::Reaction::none;
  Manual manual_ = Manual::rest;
  int jog_direction_ = 0;
  double goal_ = 0.0;          ///< of Manual::plc: position, or speed with its sign
  bool goal_endless_ = false;  ///< it is a speed
  MotionLimits goal_limits_;
  image::JogEnd jog_end_ = image::JogEnd::none;
  image::Nanoseconds now_ns_ = 0;
  image::Nanoseconds keep_alive_ns_ = 0;
  double time_scale_ = 1.0;
  bool power_requested_ = false;
  bool power_permitted_ = false;
  bool feed_enable_ = false;
  bool reset_pending_ = false;
  double reset_left_s_ = 0.0;  ///< so long the drive is asked to take its fault back
  int plc_jog_ = 0;

  bool limit_plus_ = false, limit_minus_ = false, home_switch_ = false;
  double plus_free_s_ = 0.0, minus_free_s_ = 0.0;  ///< so long the switches have been free without a break
  bool met_plus_ = false, met_minus_ = false;      ///< they came on in this cycle, and not by bouncing
  bool homed_ = false;
  bool asleep_ = false, lets_go_ = false;  ///< its drive is a spindle's, or about to be
  bool own_motion_ = false;                ///< the ramp moves the axis, not the process
  bool stopped_by_reaction_ = false;
  bool homing_reported_ = true;  ///< the end of the homing that was asked for
  bool held_ = false;            ///< the drive held the axis in the last cycle
  bool process_given_ = false;
  bool off_path_ = false;     ///< the axis does not follow the process that goes on or stops
  bool path_moved_ = false;   ///< and the process has moved since
  bool place_asked_ = false;  ///< that its place is not known has been said
  std::uint8_t restarts_off_path_ = 0;
  double path_end_ = 0.0;  ///< where the process ended
  double off_path_rest_s_ = 0.0;
  bool release_pending_ = false;
  Setpoint process_;
  MotionState geared_;

  MotionState set_;
  double compensation_value_ = 0.0;
  std::array<Sent, kHistory> history_{};
  int head_ = 0;
  image::DriveFeedback drive_;
  bool probe_armed_ = false, probe_negative_ = false;
  image::LatchSource probe_source_ = image::LatchSource::probe_1;
  std::uint32_t probe_sequence_ = 0;  ///< of the drive, when it was armed
  bool seen_online_ = false;
  bool seen_counts_ = false;
  std::uint32_t last_missed_ = 0;
  double late_s_ = 0.0;  ///< of the cycle at hand
  std::int64_t last_counts_ = 0;
  double motor_ = 0.0;  ///< drive position in machine units, compensation included
  double actual_ = 0.0;
  double actual_velocity_ = 0.0;
  double following_error_ = 0.0;
  double following_limit_ = 0.0;  ///< at the speed of this cycle
  double following_warn_ = 0.0;   ///< the same for the warning
  bool following_warned_ = false;
  double window_ = 0.0;      ///< in position, of a program; 0: the configuration's
  double rest_s_ = 0.0;      ///< the set-point has stood for so long
  double inside_s_ = 0.0;    ///< and the feedback inside the window for so long
  double brake_mark_ = 0.0;  ///< motor position at which the brake closed
  bool brake_marked_ = false;
  bool moving_ = false;
  bool actual_standing_ = true;
  bool in_position_ = false;
};

}  // namespace servogate::axis
