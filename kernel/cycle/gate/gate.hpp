// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/coupling/electronic_gear.hpp"
#include "kernel/axis/spindle.hpp"
#include "kernel/cycle/boundary/participants.hpp"

namespace servogate::cycle {

/// Why the gate refuses; image::Answer::refusal. `value` and `limit` of the answer mean what is said here.
enum class Refusal : std::uint16_t {
  none,
  unknown_request,
  asker_may_not,    ///< value: the request's kind
  no_such_axis,     ///< value: what was asked for
  no_such_process,  ///< value
  bad_value,        ///< value; limit: the largest permitted one, 0 where none can be said
  alarm_active,     ///< value: number of the first alarm
  emergency_stop,
  not_powered,       ///< axis: the drive is off or the brake still closed
  not_homed,         ///< axis
  feed_not_enabled,  ///< axis: its feed_enable is FALSE
  program_runs,
  program_does_not_run,
  program_not_held,
  not_stepping,  ///< held in another mode than STEP
  no_program,
  wrong_mode,  ///< value: the mode in force
  homing_runs,
  axis_owned,            ///< axis; value: image::AxisOwner
  axis_moves,            ///< axis
  manual_held,           ///< value: image::Asker that holds manual control
  on_hard_limit,         ///< axis; value: +1 or -1
  at_soft_limit,         ///< axis; limit: the travel limit, value: the position
  no_home_needed,        ///< axis: needs no homing
  place_not_writable,    ///< value: byte
  place_outside,         ///< value: byte; limit: size of the packet
  start_not_permitted,   ///< the place that permits starting is FALSE
  jog_range,             ///< axis; value: the distance; limit: the longest one
  zero_range,            ///< axis; value: what the position was to be; limit: the largest magnitude
  override_range,        ///< value: the ratio; limit: the largest one
  emergency_stop_place,  ///< a place of the emergency stop is never forced
  logic_not_changed,     ///< the prepared change of the PLC is not there any more, or finds no room
  axis_not_auxiliary,    ///< axis: the machine file gives it to the programs, not to the PLC
  outside_travel,        ///< axis; value: the position asked for; limit: the travel limit that it is beyond
  velocity_range,        ///< axis; value; limit: the largest one
  acceleration_range,    ///< axis; value; limit: the largest one
  axis_stopping,         ///< axis: MC_Stop holds it
  drives_not_wanted,     ///< the operator has not asked for the drives
  axis_error_stop,       ///< axis: an error stopped it, MC_Reset has not come yet
  switching_off,         ///< axis: it ramps down to be switched off, or its brake closes
  program_stopping,      ///< value: the process; its program has been ended, its path is not at rest yet
  handwheel_stopped,     ///< axis: a stop or a hold ended its motion; the handwheel is to be selected anew
  drives_on,             ///< a drive is on, or a spindle turns
  logic_held,            ///< the PLC is held for single scans already
  logic_not_held,        ///< it is not held
  forces_full,           ///< no more places can be forced
  no_torque,             ///< axis: the machine file gives it no torque
  torque_range,          ///< axis; value; limit: the largest magnitude, per cent of the rated torque
  torque_ramp_range,     ///< axis; value; limit: the greatest one, per cent a second
  jogged_by_another,     ///< axis: another hand (image::Hand) has the continuous jog under way
  // A place that guards motion or energy is forced, changed and released at standstill only:
  guard_program,  ///< value: the process whose program is in progress
  guard_homing,
  guard_axis,     ///< axis: it moves
  guard_spindle,  ///< value: index of the spindle that is to turn or still turns
  too_old,        ///< value: how long it lay before a cycle could take it, ms; limit: the longest it may
  client_gone,    ///< whoever asked is not there any more
  // Beside a held program:
  function_runs,  ///< a typed function is under way
  way_back_full,  ///< axis: the last one; the way that the axes went has too many legs to go on with another
  on_path,        ///< no axis was jogged away
  off_path,       ///< axis; value: how far it was jogged away
  retraced,       ///< value: path from where the axes stand to where the program was held, mm (degrees)
  spindle_differs,  ///< value: rpm of the spindle when the program was held, + clockwise
  tool_differs,     ///< value: the tool that was in the spindle then
  axis_is_spindle,  ///< axis: its drive is a spindle's now
  no_path_wheel,    ///< the machine file declares no handwheel for the path of this process
  // Of electronic gears:
  no_gear,         ///< axis; value: the number that was asked for; limit: how many the axis has
  axis_geared,     ///< axis: it follows a master
  gear_master,     ///< axis: its master gives no position
  gear_too_fast,   ///< axis; value: the speed that the master asks for; limit: the axis' largest
  gear_off_place,  ///< axis; value: how far it is off its place behind its master; limit: window
};

/// Largest magnitude, in mm or degrees, of a value that `zero` gives a position, and of a jog of an axis
/// without travel limits: what the displays of the old controls hold.
inline constexpr double kLargestCoordinate = 99'999.999;

/// What the gate knows of the machine at this moment, all of it by reference.
struct GateContext {
  const image::ProcessImage* image = nullptr;
  std::span<const axis::Axis> axes;
  std::span<const axis::Spindle> spindles;
  image::Reaction reaction = image::Reaction::none;  ///< in force
  image::AlarmNumber first_alarm = 0;
  bool program_loaded = false;                 ///< of the request's process
  bool holding = false;                        ///< it slows down on its path to be held
  bool path_wheel = false;                     ///< the process of the request has one
  const axis::ElectronicGear* gear = nullptr;  ///< that the request names, nullptr: there is none
  int gears = 0;                               ///< of the request's axis
  std::uint32_t stopping =
      0;  ///< bit of each process whose program has been ended and whose path still stops
  bool homing_runs = false;
  bool manual_held = false;  ///< somebody holds manual control (jogs, or a pendant with its dead-man)
  image::Asker holder = image::Asker::command_line;
  bool start_permitted = true;
  bool drives_wanted = true;                  ///< the operator has asked for the drives
  bool axis_stopping = false;                 ///< PlcMotion of the request's axis
  bool axis_error_stop = false;               ///< the same
  bool logic_held = false;                    ///< the PLC is held for single scans
  Beside beside;                              ///< of the process that beside_process() names
  const image::Place* estop_place = nullptr;  ///< emergency-stop chain, nullptr: none is declared
};

/// Axes that a `home` request names, as bits: the one of its axis; without one those of its value, or all
/// that are not the PLC's when that is 0. real-time safe.
std::uint32_t homing_mask(const image::Request& request, std::span<const axis::Axis> axes) noexcept;

/// The one gate to motion: decides on a request, changes nothing. An accepted request (refusal 0) is carried
/// out by the executive with plain calls to axes and channel. real-time safe.
image::Answer decide(const image::Request& request, const GateContext& context) noexcept;

/// The process whose held program the request may be beside of: that of the axis of a jog, else the request's
/// own; it may be out of range. real-time safe.
int beside_process(const image::Request& request, std::span<const axis::Axis> axes) noexcept;
/// The request brings a mode along that it does not need: a jog beside a held program. real-time safe.
bool keeps_mode(const image::Request& request, const GateContext& context) noexcept;

/// The request begins or continues motion, or makes it possible. real-time safe.
bool moves(image::RequestKind kind) noexcept;

/// The request takes something away (motion, energy, a program under way) and begins nothing: it is carried
/// out however old it is, and whoever asked. Every other one is refused when it lay too long or its client is
/// gone: what was right to begin then may hurt somebody now. real-time safe.
bool never_too_old(const image::Request& request) noexcept;

/// "the command line": an asker as people call it. Not real-time safe.
std::string asker_words(image::Asker asker, text::Language language);

/// The sentence for a refusal, e.g. "X is not homed: run `servogate home X` first". Empty for
/// an accepted request. `axis_units`: "mm" or "deg" of each axis, mm where there are none. Not real-time
/// safe.
std::string render(const image::Answer& answer, const std::vector<std::string>& axis_letters,
                   text::Language language, const std::vector<std::string>& axis_units = {});
/// Table of the sentences, index = Refusal. Placeholders {0} axis, {1} value in words, {2} limit, {3} unit of
/// the axis.
std::span<const text::Entry> refusal_texts() noexcept;

}  // namespace servogate::cycle
