// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/packets.hpp"
#include "kernel/axis/gears/gearbox.hpp"
#include "kernel/axis/inverter/inverter.hpp"
#include "kernel/axis/setpoint/ramp.hpp"
#include "kernel/axis/torque/torque_control.hpp"

namespace servogate::axis {

/// A switch as a place of packet A.
struct SwitchPlace {
  image::Place place;
  bool inverted = false;  ///< TRUE in the packet means "not on the switch" (break contact)
};

enum class HomingMethod : std::uint8_t {
  none,              ///< needs no homing: reference_counts of the configuration hold from the start
  switch_and_index,  ///< decisive edge of the home switch, then the next zero mark
  switch_only,       ///< decisive edge of the home switch
  index_only,        ///< next zero mark in the direction of search
  drive,             ///< the drive does it by a method of its own; the set-point follows the feedback
  absolute,          ///< absolute encoder: the kept reference holds; without one the axis is not homed
};

/// How an axis finds its home position.
struct HomingData {
  HomingMethod method = HomingMethod::switch_and_index;
  int direction = -1;  ///< of the search for the switch, -1 or +1
  int release_direction =
      -1;  ///< direction in which the decisive edge is crossed slowly and the zero mark is sought:
           ///< equal to `direction`: driving onto the switch; opposite: leaving it
  double fast = 20.0;      ///< speed of the search, mm/s
  double slow = 2.0;       ///< speed over the decisive edge and to the zero mark, mm/s
  double position = 0.0;   ///< machine position of the captured edge or zero mark
  bool final_move = true;  ///< move to `final_position` at the end
  double final_position = 0.0;
  double max_travel = 1000.0;      ///< way of each search, mm; then "switch not found"
  double max_index_travel = 20.0;  ///< way from the edge to the zero mark, mm
  double index_spacing = 0.0;      ///< way from zero mark to zero mark, mm; 0: not known, not checked
  double timeout_s = 60.0;         ///< for the whole of it
  double drive_limit_time = 0.0;   ///< method drive: so long, in s, it may move into a limit switch: it turns
                                   ///< round there; 0: by a method that has no business there
  int order = 1;                   ///< axes with the same number home together, lower numbers first
  bool edges = false;              ///< the home switch tells its edges with times: its edge is met by them
};

/// A point of the pitch table: at `position` the drive has to stand further by this much (mm) for the axis to
/// stand right; approached in the positive and in the negative direction.
struct PitchPoint {
  double position = 0.0;
  double plus = 0.0;
  double minus = 0.0;
};

enum class BrakeOutput : std::uint8_t { none, drive, place };

/// Holding brake. Delays in seconds.
struct BrakeData {
  BrakeOutput output = BrakeOutput::none;
  SwitchPlace place;            ///< of BrakeOutput::place: TRUE releases (inverted: FALSE releases)
  double command_time = 0.0;    ///< from the cycle of a command until the output has it, at the latest; the
                                ///< release and engage delays begin there
  double torque_delay = 0.05;   ///< from Operation enabled until the drive surely holds the load
  double release_delay = 0.10;  ///< from the release until the axis may move
  double engage_delay = 0.10;   ///< from engaging until the power may go
  double slip_window = 0.5;     ///< permitted movement while the brake opens or closes, mm
};

/// Everything an axis is, as plain data from the machine file. mm or degrees, seconds; a lathe's X is a
/// radius.
struct AxisConfig {
  int process = 0;  ///< whose programs move it at first; see Axis::assign()
  bool rotary = false;
  bool auxiliary = false;                ///< the PLC moves it (magazine, chuck); no program, nobody by hand
  std::int64_t counts_numerator = 1000;  ///< exactly numerator / denominator counts make one mm or degree
  std::int64_t counts_denominator = 1;
  int count_direction = 1;  ///< -1: counts fall while the position rises
  MotionLimits limits{500.0, 1000.0, 10000.0};
  double travel_min = -300.0;
  double travel_max = 300.0;
  bool travel_limited = true;             ///< false: an endless rotary axis
  double following_error_limit = 1.0;     ///< at rest ...
  double following_error_warn = 0.0;      ///< the same for a warning, below the limit; 0: none
  double following_error_velocity = 0.0;  ///< ... and so much more for each mm/s of the set-point, both
  double in_position_window = 0.01;
  double in_position_time = 0.01;  ///< to be inside the window so long
  double in_position_timeout =
      2.0;  ///< alarm when not in position so long after the set-point stopped; 0: none
  double standstill_velocity = 0.5;  ///< measured speed below which the axis stands
  HomingData homing;
  std::int64_t reference_counts = 0;  ///< method none: counts at homing.position
  std::optional<SwitchPlace> limit_plus;
  std::optional<SwitchPlace> limit_minus;
  std::optional<SwitchPlace> home_switch;
  double backlash = 0.0;          ///< >= 0
  std::vector<PitchPoint> pitch;  ///< rising positions; outside the table its end values hold
  BrakeData brake;
  TorqueData torque;
  double jog_velocity = 50.0;  ///< continuous and incremental jogging
  double slow_velocity = 5.0;  ///< while not homed, and away from a hard limit
  double keep_alive_s = 0.1;   ///< a continuous jog without a keep-alive begins to stop after this
  image::PartPlace drive;
  int feedback_delay = 2;          ///< cycles from a command to the feedback that shows it carried out, 1-15
  std::uint32_t missed_limit = 3;  ///< consecutive cycles without process data, then an alarm
  image::Reaction loss_reaction =
      image::Reaction::stop_on_path;  ///< to the loss of its drive, or a stronger one
};

/// By what a spindle or an axis follows another one.
enum class CouplingBy : std::uint8_t {
  none,      ///< it is never coupled
  setpoint,  ///< the set-point; a spindle that leads is then held to it by its position
  measured,  ///< what the other one's encoder shows
};

/// A spindle, as plain data from the machine file.
struct SpindleConfig {
  int process = 0;                       ///< whose S, M3, M4, M5 and M19 it obeys
  std::int64_t counts_numerator = 4096;  ///< exactly numerator / denominator counts make one revolution
  std::int64_t counts_denominator = 1;
  int count_direction = 1;  ///< +1: counts rise clockwise (M3)
  double max_rpm = 6000.0;
  double min_rpm = 0.0;            ///< a lower wish other than 0 is raised to it, override included
  double acceleration = 3000.0;    ///< rpm/s
  double at_speed_window = 0.05;   ///< of the commanded speed
  double at_speed_timeout = 10.0;  ///< alarm when not at speed so long after the ramp ended; 0: none
  double zero_speed_rpm = 5.0;     ///< standstill below this
  double orient_angle = 0.0;       ///< degrees
  double orient_rpm = 60.0;
  double orient_window = 0.5;  ///< degrees
  double orient_timeout = 10.0;
  double orient_gain = 5.0;    ///< 1/s, speed for each degree of error; below 1 / (2 x dead time)
  double encoder_delay = 0.0;  ///< s by which its counts are older than those of a drive latched at SYNC
  bool encoder = true;         ///< the supplier gives counts; without them no oriented stop
  image::PartPlace drive;
  std::optional<InverterConfig> inverter;  ///< supplies the spindle instead of a drive, without an encoder
  GearboxConfig gearbox;    ///< its counts are those of the motor, as if the first gear were in force
  int source = -1;          ///< image.sources[n] tells whether its drive is there; -1: the drive's bus does
  bool reverses = true;     ///< its drive can turn counter-clockwise
  bool target_bit = false;  ///< at speed only where its drive says so, too (statusword bit 10)
  image::Reaction loss_reaction = image::Reaction::stop_on_path;  ///< of one with a source, or stronger
  std::uint32_t missed_limit = 3;
  bool thread_by_setpoint =
      false;  ///< threads go by the commanded angle, to which it is held by its position
  CouplingBy coupling = CouplingBy::none;
  double coupling_window = 2.0;  ///< degrees off the angle it is led to; beyond: synchronism is lost
  int axis = -1;  ///< place in the image of the rotary axis that it becomes, with the same drive; -1: none
};

/// An axis that follows another one, or a spindle, at a ratio of whole numbers. Turns are those of spindles
/// and rotary axes; of a linear axis a millimetre counts as one.
struct ElectronicGearConfig {
  int follower = -1;                ///< place of the axis in the image
  int master_axis = -1;             ///< place of the axis that leads; -1: the spindle
  int master_spindle = -1;          ///< place of the spindle that leads
  std::int64_t follower_turns = 1;  ///< not 0; below 0 it goes the other way ...
  std::int64_t master_turns = 1;    ///< ... for so many of its master, above 0
  CouplingBy by = CouplingBy::setpoint;
  double window = 1.0;          ///< mm or degrees of the follower off its place; beyond: alarm
  std::optional<double> phase;  ///< mm or degrees of the follower where its master is at zero; none: where
                                ///< both are when the follower has its speed

  bool operator==(const ElectronicGearConfig&) const = default;
};

}  // namespace servogate::axis
