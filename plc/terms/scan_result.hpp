// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/time.hpp"

namespace servogate::plc {

/// Why a scan was abandoned. From then on every place that the PLC program writes is held at FALSE or 0, so
/// that enables and outputs drop, until the engine's restart.
enum class Fault : std::uint8_t {
  none,
  budget,              ///< more instructions than Options::instruction_budget
  division_by_zero,    ///< integer, real or TIME; MOD by zero is 0 by IEC 61131-3
  index_out_of_range,  ///< array subscript
  subrange,            ///< a value outside the subrange of the variable it is assigned to
  conversion,          ///< a real that no value of the integer type stands for, or text that is no number
  selector,            ///< K of MUX names no input
  text_position,       ///< L or P of a string function is negative or lies outside the string
  null_reference,      ///< dereference of NULL
  overrun,             ///< it did not come back in time and was ended from outside (ScanWatch)
  packet_size,         ///< packet K or SYVAR is smaller than the program was compiled for
};

/// Outcome of one scan. Plain data, so that the cycle can turn it into an alarm.
struct ScanResult {
  Fault fault = Fault::none;
  std::int16_t task = -1;         ///< index for Engine::task_name
  std::int16_t file = -1;         ///< index for Engine::file_name
  std::int32_t line = 0;          ///< line of the statement, 0: none
  std::int64_t instructions = 0;  ///< upper bound of the instructions executed
};

/// How long a task or a block took. Of blocks, calls of others inside are part of it.
struct Times {
  image::Nanoseconds last = 0, most = 0, sum = 0;
  std::int64_t count = 0;  ///< scans of a task, calls of a block

  void add(image::Nanoseconds t) noexcept {
    last = t;
    most = t > most ? t : most;
    sum += t;
    ++count;
  }
};

}  // namespace servogate::plc
