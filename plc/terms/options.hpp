// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::plc {

/// One file of PLC source as it was read: `name` appears in findings, `text` is UTF-8.
struct SourceFile {
  std::string name;
  std::string text;
};

/// What the compiler has to know about the machine beside its symbols.
struct Options {
  std::uint32_t k_bytes = image::kPacketKDefaultSize;  ///< size of packet K, for the range check of places
  std::uint32_t v_bytes = image::kSyvarDefaultSize;    ///< size of SYVAR
  /// Instructions that one scan may execute, all tasks together; more is Fault::budget. 1 million take about
  /// one to two milliseconds.
  std::int64_t instruction_budget = 1'000'000;
  /// The machine's cycle, for the warning of tasks that ask for more; 0: not known.
  image::Nanoseconds cycle_ns = 0;
  bool warnings = true;
  /// Declarations without a PROGRAM are a library and no mistake; nothing runs.
  bool program_optional = false;
  /// Instructions of all bodies together; more is the error `plc-code-size`, and compiling ends there. Each
  /// takes 20 bytes, and another 10 or so while compiling.
  std::size_t most_instructions = 4'000'000;
  /// Asked again and again, for every line in every stage, when there is one: true, e.g. when a time is up,
  /// and compile() asks no more and returns, with the error `plc-compile-cancelled` and no image.
  std::function<bool()> stop = {};
};

}  // namespace servogate::plc
