// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::image {

/// Who asks. Every request names its asker; the gate to motion decides by it.
enum class Asker : std::uint8_t { command_line, page, pendant, plc, scenario, modbus, program, bench };

enum class RequestKind : std::uint8_t {
  none,
  power,           ///< value 1: drives on, 0: off
  home,            ///< axis, or -1 for all in the machine's order
  jog_increment,   ///< axis, value = signed distance in mm or degrees, at most the axis' whole travel
  jog_continuous,  ///< axis, value = +1 or -1; needs keep_alive at least every 100 ms of the wall clock
  keep_alive,      ///< axis, or -1 for all that this Hand jogs; no other hand's jog is kept alive by it
  jog_stop,  ///< axis, or -1 for all; value 1: its keep-alive was missed, which ends this Hand's jog only
  zero,      ///< axis, value = the value the present position gets in the active origin
  mode,      ///< value = image::Mode
  start,
  step,
  hold,
  resume,
  stop,  ///< controlled stop on the path, program ends
  reset,
  override_feed,  ///< value = ratio 0-1.5
  quick_stop,
  acknowledge,  ///< alarms
  set_place,    ///< place (packed) and value: an operator's write into packet K, a force, a simulated input
  force,
  release_force,
  logic,  ///< index = number of a prepared change of the PLC; value 1: it may happen while the machine moves
  // Of an auxiliary axis, for the PLC alone:
  axis_power,     ///< axis, value 1: drive on, 0: off
  axis_home,      ///< axis
  move_absolute,  ///< axis, value = machine position, velocity, acceleration
  move_relative,  ///< axis, value = distance from the target in force, velocity, acceleration
  move_velocity,  ///< axis, value = +1 or -1, velocity, acceleration
  axis_stop,      ///< axis
  axis_reset,     ///< axis: its alarms, as far as their causes are gone
  logic_scan,     ///< value 1: the PLC is held, 2: then runs `index` scans, 0: runs freely again
  /// Axis; value = torque in per cent of the rated one, velocity = its limit, acceleration = ramp in per cent
  /// a second, 0: the axis' own. An auxiliary one, for the PLC alone.
  torque,
  assign,  ///< axis, process: whose programs move it from now on; at standstill, while no program of either
           ///< runs
  tables,  ///< origins and tools are changed; index: axes whose present position is taken over, as bits
  // Beside a program that is held, or waits for the operator:
  reposition,  ///< the axes that were jogged away return by the way that they went, then along the path that
               ///< was retraced; velocity = feed in mm/s or degrees/s, 0: the axes' jog speed, as programmed
  retrace,     ///< back along the path: value = so much path in mm (degrees where only rotary axes move), or
               ///< index = to the begin of so many blocks; velocity = feed as of reposition, 0: as programmed
  function,    ///< index = image::Function; value = M code, tool number or rpm; packet = number of the
               ///< process' spindle, format = corrector of the tool
  path_wheel,  ///< index = image::WheelNews; value = 1 or 0, or counts
  gear,        ///< axis, value = number of its electronic gear that engages, 0: it is disengaged; of the PLC
};

/// What `path_wheel` says of the handwheel that drives a program along its path.
enum class WheelNews : std::uint8_t {
  choose,  ///< value 1: the program follows it from now on, 0: no more
  turned,  ///< value = counts, + forward; of a pendant
  here,    ///< value 1: the pendant is plugged in, 0: it is lost
};
inline constexpr int kWheelNews = static_cast<int>(WheelNews::here) + 1;

/// What `function` does.
enum class Function : std::uint8_t {
  m,
  tool,
  spindle_clockwise,         ///< M3, value = rpm
  spindle_counterclockwise,  ///< M4, value = rpm
  spindle_stop,              ///< M5
};
inline constexpr int kFunctions = static_cast<int>(Function::spindle_stop) + 1;

/// Who holds a jog with a finger on the button: one connection, one pendant, the PLC. The dead-man of a
/// continuous jog is its hand's alone: nobody else keeps it alive.
struct Hand {
  Asker asker = Asker::command_line;
  std::uint32_t client =
      0;  ///< number of the connection; 0: there are no several (PLC, a run's own operator)
  friend constexpr bool operator==(const Hand&, const Hand&) = default;
};

/// A wish from outside, posted to the cycle through one bounded queue. Plain data.
struct Request {
  std::uint64_t id = 0;  ///< chosen by the asker, returned in the answer
  Asker asker = Asker::command_line;
  RequestKind kind = RequestKind::none;
  std::int8_t axis = -1;
  std::int8_t process = 0;
  /// image::Mode in which the process is to be for this request (home, jogs, start, step), -1: as it is.
  /// Decided and done together with the request; a refused one leaves the mode as it was.
  std::int8_t mode = -1;
  std::uint8_t packet = 0, format = 0, length = 1;  ///< image::Place of set_place and force
  std::uint32_t index = 0;
  std::uint32_t client = 0;  ///< of the asker, see Hand
  double value = 0.0;
  double velocity = 0.0;      ///< of moves: mm/s or degrees/s, above 0
  double acceleration = 0.0;  ///< of moves; 0: the axis' limit

  /// real-time safe.
  constexpr Hand hand() const noexcept { return {asker, client}; }
};

/// The gate's answer. `refusal` is 0 when accepted, otherwise a key of the gate's table of sentences
/// (kernel/cycle/gate.hpp); axis, limit and value fill its placeholders.
struct Answer {
  std::uint64_t id = 0;
  std::uint16_t refusal = 0;
  std::int8_t axis = -1;
  double limit = 0.0;
  double value = 0.0;
};

}  // namespace servogate::image
