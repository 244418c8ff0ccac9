// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/detail.hpp"
#include "firmware_if/image/part_place.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::image {

/// What a fault makes the machine do, in rising severity (docs/architecture.md, rule 8).
enum class Reaction : std::uint8_t {
  none,
  warn,
  stop_at_block_end,
  stop_on_path,        ///< controlled stop of all axes of the process together, on the programmed path
  stop_axes,           ///< controlled stop of each axis at its own limits
  stop_and_power_off,  ///< the same; at rest the brakes engage, then the power goes
  quick_stop,          ///< the drives' own quick stop
  power_off,           ///< at once: brakes engage, power goes, what moves coasts
};

/// Number of an alarm: its row in the one alarm table (alarms/alarm_table.hpp).
using AlarmNumber = std::uint16_t;

/// One fault as it happened. Plain data, so that the cycle can write it; texts come from the table.
struct AlarmRecord {
  std::uint32_t sequence = 0;  ///< rises by one with every record
  std::uint32_t first_fault =
      0;  ///< sequence of the fault this one is a consequence of; own sequence = first
  AlarmNumber number = 0;
  Reaction reaction = Reaction::none;
  bool active = true;
  std::int64_t cycle = 0;
  Nanoseconds t_ns = 0;
  std::int8_t process = -1;
  std::int8_t axis = -1;     ///< index in the machine file's order, -1: none
  PartPlace part;            ///< part of a device that it is of
  std::int16_t source = -1;  ///< index in ProcessImage::sources
  /// Tells faults of one number at one place apart: an error code, an identifier, an object. While one is
  /// active, only a fault with another key is an alarm of its own.
  std::uint64_t key = 0;
  std::int32_t line = 0;  ///< line of the block in motion, 0: none
  std::int32_t file = 0;  ///< its file in run `run` of the process (ProcessStatus)
  std::uint32_t run = 0;
  std::int32_t block = -1;  ///< its N number
  double limit = 0.0;       ///< what was allowed ...
  double value = 0.0;       ///< ... and what was met, in the unit the table names
  double detail1 = 0.0;     ///< further figures that the table names, e.g. the velocity of a following error
  double detail2 = 0.0;
  Detail detail;  ///< what only its device and the words for people know
};

}  // namespace servogate::image
