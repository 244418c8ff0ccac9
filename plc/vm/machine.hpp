// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>

#include "plc/terms/scan_result.hpp"
#include "plc/vm/image.hpp"
#include "plc/vm/opcodes.hpp"

namespace servogate::plc::vm {

/// What a run needs beside the code: memory, time, the rest of the budget.
struct Machine {
  std::uint8_t* memory = nullptr;
  const Image* image = nullptr;
  std::int64_t now_ns = 0;
  std::int64_t budget = 0;
  std::uint64_t scan = 0;  ///< number of the scan in ...
  const std::atomic<std::uint64_t>* ended =
      nullptr;  ///< ... which it ends when it stands here; never null in execute()
  const std::uint8_t* extra[2] = {nullptr, nullptr};  ///< third and fourth input of a native function
  std::uint32_t at = 0;                               ///< instruction of a fault
  const image::Clock* clock = nullptr;                ///< measures calls, when `blocks` is there
  Times* blocks = nullptr;                            ///< by Image::units
};

/// Runs from `entry` to the return of that body. real-time safe.
Fault execute(Machine& machine, std::uint32_t entry) noexcept;

/// A function of the machine: reads a and b (and extra), writes d. real-time safe.
using NativeFunction = Fault (*)(Machine& m, std::uint8_t* d, const std::uint8_t* a,
                                 const std::uint8_t* b) noexcept;

/// Numbers for Instruction::aux of Code::native.
std::uint16_t convert_function(Cell from, Cell to) noexcept;
std::uint16_t truncate_function(Cell from, Cell to) noexcept;
/// Of an expression of the kind `native`, by it and the types of its inputs.
std::uint16_t native_function(const ir::Expr& e) noexcept;
/// One character as a text of its kind.
std::uint16_t character_text_function(bool wide) noexcept;
std::uint16_t compare_text_function(bool wide) noexcept;
std::uint16_t pick_text_function(bool greatest, bool wide) noexcept;
NativeFunction native_at(std::uint16_t number) noexcept;

}  // namespace servogate::plc::vm
