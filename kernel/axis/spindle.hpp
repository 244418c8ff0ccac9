// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/alarms/axis_alarms.hpp"
#include "kernel/axis/config/axis_config.hpp"
#include "kernel/axis/coupling/angle_track.hpp"
#include "kernel/axis/coupling/coupling.hpp"
#include "kernel/axis/gears/gearbox.hpp"
#include "kernel/axis/setpoint/scale.hpp"

namespace servogate::axis {

class Axis;

enum class SpindleMode : std::uint8_t { stop, cw, ccw, orient, turn, follow };

/// Where an encoder stands, as the master of a path.
struct SpindleAngle {
  bool valid = false;  ///< it is known: from the zero mark, or from switching on where the drive tells none
  std::int64_t turns = 0;        ///< whole revolutions, + clockwise
  double part = 0.0;             ///< of a revolution, 0 - 1
  image::Nanoseconds at_ns = 0;  ///< machine time at which it stood there
};

/// What a follower asks of the spindle that leads it.
struct LeadDemand {
  bool by_setpoint = false;  ///< it is to be held to its commanded angle
  bool in_step = false;      ///< both go together already
  double rpm_s = 1e12;       ///< the most that it is to speed up ...
  double rpm = 1e12;         ///< ... and turn
};

/// A spindle: ramped speed command, at-speed and standstill, oriented stop. Its supplier is a CSV drive in
/// SpindleImage (CiA 402, or an inverter on a line), or an inverter on outputs of packet A. In each cycle:
/// read(image), react(reaction), command(image); all real-time safe.
///
/// An inverter gives no feedback: at speed is its command, standstill its ramp. Speed and relays go to 0 at
/// once with the reactions quick stop and power off, without MC.power_on, and when a station of theirs is
/// lost; then the order is stop, and nothing turns again unasked. The same order is given when a drive is
/// lost or in fault, whatever it was told before; whether that spindle stands is not known then.
///
/// S.limit of the PLC bounds the speed whatever is ordered (the chuck and the work in it), at once and by the
/// ramp.
///
/// With gear ranges an order to turn chooses the gear (the PLC by S.gear_wish, otherwise the slowest that
/// reaches the speed); another one than that in force brings the spindle to rest, or to its speed for
/// changing, changes, and then turns. A speed that is only adjusted stays within the gear. A gear that is not
/// confirmed is a stop and an alarm.
///
/// One that follows another (couple()) turns by the other's speed and is held to its angle by the position
/// loop; the leader turns no faster and speeds up no more than the follower can go with. A stop of the
/// follower ends the coupling: where it was in step it ramps as the leader would. In an emergency stop,
/// without its enable and above S.limit each of them has its own ramp. A leader that rests, or whose drive is
/// off at standstill, leads nowhere until it is told to turn, whoever moves it.
///
/// One with SpindleConfig::axis becomes a rotary axis when it is told to (want_axis()): it stops oriented
/// where that axis stood last, its drive goes off, and comes on again in csp as the axis' own, which knows
/// its place from the zero mark. Back it goes at rest: the axis lets go, and the spindle stands without an
/// order. As an axis it takes no order to turn. Where its drive goes away it is a spindle: the place of the
/// axis is not known any more.
class Spindle {
 public:
  /// `index` is the spindle's place in the image. Not for the cycle.
  void configure(const SpindleConfig& config, int index);
  const SpindleConfig& config() const noexcept { return config_; }
  int index() const noexcept { return index_; }

  /// What the program wants; `rpm` without sign, clamped to the configured range. What this spindle cannot do
  /// (an oriented stop without an encoder, a direction without a relay) is a stop and an alarm. real-time
  /// safe.
  void order(SpindleMode mode, double rpm) noexcept;
  /// On by an angle, + clockwise, at a speed, from where an oriented stop or a turn before it leads; it is
  /// held there as an oriented stop is. Where the angle is not known it is a stop and an alarm. real-time
  /// safe.
  void turn(double degrees, double rpm) noexcept;
  /// Follows the leader's angle from now on; an order to stop or uncouple() ends it, any other one is refused
  /// by an alarm. real-time safe.
  void couple(const CouplingOrder& order) noexcept;
  void uncouple() noexcept;
  bool coupled() const noexcept { return link_.on(); }
  /// Coupled, or still braking behind it: it has a leader.
  bool has_leader() const noexcept { return coupled() || parting_; }
  bool synchronous() const noexcept { return link_.synchronous(); }
  /// What a follower asks of its leader, before the leader's command() in each cycle. real-time safe.
  void lead(const Spindle& follower) noexcept;
  void lead(const LeadDemand& demand) noexcept;
  /// The leader, which has had its command() of this cycle; before the follower's own. real-time safe.
  void follow(const Spindle& leader, const image::CycleTime& now) noexcept;
  /// It is to be the rotary axis of its configuration, or a spindle; see share(). real-time safe.
  void want_axis(bool axis) noexcept { wants_axis_ = axis && config_.axis >= 0; }
  bool wants_axis() const noexcept { return wants_axis_; }
  /// It is the axis, at its place and under power.
  bool is_axis() const noexcept { return use_ == Use::axis; }
  /// It is a spindle, and on no way to anything else.
  bool is_spindle() const noexcept { return use_ == Use::spindle; }
  /// One cycle of the change between the two, before the command() of both. real-time safe.
  /// What keeps it from becoming the axis, and no alarm tells otherwise, is an alarm.
  void share(Axis& axis, double dt) noexcept;
  /// Its drive as that of the axis, before both are read. real-time safe.
  void show_drive(image::ProcessImage& image) const noexcept;
  /// Another speed of the mode in force, as often as is liked: what is waited for goes on. real-time safe.
  void adjust(double rpm) noexcept;
  SpindleMode mode() const noexcept { return mode_; }
  double ordered_rpm() const noexcept { return ordered_rpm_; }

  void read(image::ProcessImage& image) noexcept;
  void react(image::Reaction reaction) noexcept { reaction_ = reaction; }
  void command(image::ProcessImage& image) noexcept;
  const Events& events() const noexcept { return events_; }
  void clear_events() noexcept { events_.clear(); }
  bool present(image::AlarmNumber number) const noexcept;
  void reset() noexcept;

  /// Commanded state reached: at speed, standing, or at its angle. real-time safe.
  bool settled() const noexcept;
  bool at_speed() const noexcept { return at_speed_; }
  bool zero_speed() const noexcept { return zero_speed_; }
  bool oriented() const noexcept { return oriented_; }
  double actual_rpm() const noexcept { return actual_rpm_; }
  /// The same with its revolutions and its time, exact however long the spindle runs; a reading that did not
  /// come keeps the time of the one before. real-time safe.
  const SpindleAngle& angle() const noexcept { return master_; }
  /// Of one whose threads go by its set-point: revolutions by which the commanded angle was ahead of angle()
  /// at the time of that; none: it is not led by its set-point now. real-time safe.
  std::optional<double> setpoint_ahead() const noexcept;
  /// Of one that leads by its set-point: the commanded angle at a time, turns from the zero of angle(), speed
  /// in turns/s and its change in this cycle, 1/s2. real-time safe.
  std::optional<path::MasterState> commanded(image::Nanoseconds t_ns) const noexcept;
  /// It leads nowhere: it stands, and nobody has told it to turn since. real-time safe.
  bool rests() const noexcept { return rests_; }
  /// Its drive is its axis', which has had its command() after the spindle's. real-time safe.
  void pass_on(image::ProcessImage& image) const noexcept;
  /// Measured angle, 0-360 degrees, + clockwise; from the zero mark once it has been passed. real-time safe.
  double angle_deg() const noexcept { return angle_deg_; }

 private:
  enum class Use : std::uint8_t {
    spindle,
    orienting,  ///< to the place of the axis
    freeing,    ///< its drive goes off
    powering,   ///< the axis has its drive, which comes on in csp
    placing,    ///< the axis goes to its place, what the oriented stop is off
    axis,
    leaving,  ///< the axis lets its drive go
  };
  /// Its drive is the axis'.
  bool lent() const noexcept { return use_ >= Use::powering; }
  // spindle_axis.cpp
  void begin_axis(const Axis& axis) noexcept;
  void hand_over(Axis& axis) noexcept;
  void let_go(Axis& axis) noexcept;
  bool failed_on_its_way() noexcept;
  void give_up_axis(Axis& axis) noexcept;
  void follow_drive(double wanted, double dt) noexcept;
  // spindle_coupling.cpp
  void hold_to_angle(double dt) noexcept;
  void track_command(const image::CycleTime& now) noexcept;
  double behind_turns(bool& led) const noexcept;
  bool by_setpoint() const noexcept;
  void watch_coupling(double dt) noexcept;
  double fastest() const noexcept;
  double ramp_rpm_s(double wanted) const noexcept;
  bool urgent() const noexcept;
  void part_from_leader() noexcept;
  void note_rest() noexcept;
  void follow_inverter(image::ProcessImage& image, double& wanted, double dt) noexcept;
  void write_drive(image::ProcessImage& image, image::SpindleImage& out) const noexcept;
  void read_angle(const image::DriveFeedback& in, const image::CycleTime& now) noexcept;
  void watch_source(const image::ProcessImage& image) noexcept;
  void give_up() noexcept;
  double ordered_speed() const noexcept;
  void change_gear(image::ProcessImage& image, double dt) noexcept;
  double wanted_rpm() noexcept;
  double held_rpm(double error_deg, double most_rpm) noexcept;
  double angle_error() const noexcept;
  double total_turns() const noexcept { return static_cast<double>(master_.turns) + master_.part; }
  void supervise(double dt, bool speed_due) noexcept;
  void write_interface(image::ProcessImage& image) const noexcept;

  SpindleConfig config_;
  int index_ = 0;
  CountScale scale_;  ///< counts to revolutions
  Events events_;
  SpindleMode mode_ = SpindleMode::stop;
  double ordered_rpm_ = 0.0;
  image::Reaction reaction_ = image::Reaction::none;
  image::DriveFeedback drive_;
  Inverter inverter_;
  Gearbox gears_;
  int gear_wish_ = 0;
  bool gear_lost_ = false, raised_gear_ = false;
  bool power_on_ = false;
  bool lost_ = false;         ///< an output of the inverter, or the source of the drive
  bool seen_lost_ = false;    ///< the same one cycle ago
  bool was_online_ = false;   ///< its drive, one cycle ago
  bool turned_ = false;       ///< when its drive was last heard
  double not_ready_s_ = 0.0;  ///< wanted, and not switched on by what it says itself
  bool raised_ready_ = false;
  bool on_ = false;                ///< the supplier follows the command
  image::AlarmNumber cannot_ = 0;  ///< why the last order was none for this spindle
  bool enable_ = false;
  double override_ratio_ = 1.0;
  double limit_rpm_ = 0.0;  ///< of the machine, or the PLC's below it
  double command_rpm_ = 0.0;
  double actual_rpm_ = 0.0;
  double angle_deg_ = 0.0;
  SpindleAngle master_;
  bool began_ = false, angle_known_ = false;  ///< master_ counts from angle_zero_, until the drive is gone
  std::int64_t first_counts_ = 0, angle_zero_ = 0;
  bool orienting_ = false;   ///< slow enough, position loop closed
  double goal_turns_ = 0.0;  ///< of a turn by an angle, as total_turns() counts
  double turn_s_ = 0.0;      ///< that it takes at its speed
  double wait_s_ = 0.0;
  double off_s_ = 0.0;
  bool at_speed_ = false, zero_speed_ = true, oriented_ = false;
  bool reset_pending_ = false;
  double reset_left_s_ = 0.0;
  bool raised_speed_ = false, raised_orient_ = false, raised_fault_ = false;
  bool marked_ = false;      ///< the zero mark has been captured
  double orient_deg_ = 0.0;  ///< where an oriented stop leads

  Use use_ = Use::spindle;
  bool wants_axis_ = false;
  double place_ = 0.0;       ///< of the axis, where it goes on
  double changing_s_ = 0.0;  ///< so long it has been on its way

  Coupling link_;                                          ///< to the leader
  Led led_;                                                ///< by it, in this cycle
  double led_rpm_s_ = 0.0;                                 ///< ramp with which it and its leader go together
  bool parting_ = false;                                   ///< it brakes behind its coupling, in step
  bool rests_ = true;                                      ///< it leads nowhere
  LeadDemand leading_;                                     ///< of all its followers, in this cycle
  double last_rpm_ = 0.0;                                  ///< command_rpm_ one cycle ago
  double command_turns_s_ = 0.0, command_turns_s2_ = 0.0;  ///< in the middle of what track_ has of this cycle
  AngleTrack track_;  ///< of the commanded angle, of one that leads by it
  double correction_rpm_ = 0.0, phase_error_deg_ = 0.0;
  double apart_s_ = 0.0;  ///< coupled and turning, and not in step
};

/// The command of all spindles in a cycle. Those that lead come first: what follows has to know where to. The
/// first spindle of a process leads its others. real-time safe.
void command_all(std::span<Spindle> spindles, image::Reaction reaction, image::ProcessImage& image) noexcept;

}  // namespace servogate::axis
