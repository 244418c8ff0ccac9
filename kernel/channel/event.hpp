// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/packets.hpp"
#include "kernel/program/commands/canonical.hpp"

namespace servogate::channel {

/// What the cycle does while the path rests at an event.
enum class EventKind : std::uint8_t {
  m_function,
  h_function,
  spindle,
  tool,
  dwell,
  write,
  wait,
  spindle_mark,  ///< until spindle `number` passes its zero mark
  probe_arm,     ///< the motion that follows ends where the probe touches
  probe_end,     ///< and did not touch
  message,
  process_start,    ///< process `number` gets another program; finding `code`: its start is refused
  process_release,  ///< the program is unloaded when it has ended
  process_restart,  ///< stands until process `number` waits for this one, which sends it on
  process_wait,     ///< until process `number` sends it on
  sync,             ///< the interpreter waits for the packets as they are now
  stop,             ///< M00
  optional_stop,    ///< M01
  block_end,        ///< STEP mode: waits for the operator between blocks
  window,  ///< axis `number` counts as in position within `value`, mm or degrees; 0: as the machine has it
  feed_override,  ///< it counts from here on, with `flag`
  /// Spindle `number` follows the first, `code2` of its turns for `code`, `angle` ahead; without `flag` no
  /// more
  spindle_coupling,
  /// The first spindle becomes its rotary axis, with `flag`; without it a spindle again
  spindle_axis,
  warning,  ///< at once: the control does something otherwise than the program asks
  error,    ///< the interpreter found an error in the next block
  end,      ///< M02, M30 or the last line
};

/// path::Tag::command of this room: the run above, and below how many of its blocks have been executed. Equal
/// programs and inputs give equal numbers, whatever was read of runs given up before.
constexpr std::uint64_t run_and_block(std::uint32_t run, long long executed) noexcept {
  return std::uint64_t{run} << 32 | static_cast<std::uint32_t>(executed);
}

/// One command that the cycle executes at rest, in path order. Plain data; crosses the real-time line.
struct Event {
  std::uint32_t id = 0;  ///< the path's event, or 0: at once (asynchronous write, warning)
  std::uint32_t generation = 0;
  std::uint32_t executed = 0;  ///< blocks of the run so far, its own included
  EventKind kind = EventKind::message;
  std::int32_t line = 0;
  std::int32_t block = -1;
  std::int16_t file = 0;
  std::int32_t code = 0;    ///< M, H or tool number; number of the message or finding in ProgramTexts
  std::int32_t code2 = 0;   ///< corrector; column of a warning
  double value = 0.0;       ///< seconds, speed, value to write or to compare with
  double limit = 0.0;       ///< rpm limit of a surface speed
  double center = 0.0;      ///< where the radius of a surface speed begins
  double angle = 0.0;       ///< by which a spindle turns, degrees
  std::uint8_t number = 0;  ///< spindle, axis, or another process, from 0
  program::SpindleMode mode = program::SpindleMode::keep;
  bool flag = false;  ///< surface speed; rewind; effective
  program::Wait::Compare compare = program::Wait::Compare::eq;
  image::Place place;
  std::array<char, image::kMaxCharacters> characters{};
  std::uint8_t length = 0;  ///< of `characters`; 0: `value` counts
};

}  // namespace servogate::channel
