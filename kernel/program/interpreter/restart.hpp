// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/program/commands/canonical.hpp"
#include "kernel/program/interpreter/interpreter.hpp"

/// The way back into a program: what would be in force before a block if everything before it had run. Not
/// real-time safe.
namespace servogate::program {

/// The block at which a program is to begin.
struct RestartAt {
  enum class By : std::uint8_t {
    line,      ///< of the main program's file, from 1: the first command that it gives
    number,    ///< N of a block in the main program; the same
    executed,  ///< the n-th block that is executed, counted through loops, cycles and subprograms
  };
  By by = By::line;
  std::int64_t value = 0;
  OperatorSwitches switches = {};  ///< with which it runs, and ran
  friend bool operator==(const RestartAt&, const RestartAt&) = default;
};

/// What is in force before that block.
struct RestartPoint {
  Interpreter interpreter;  ///< its next command is the first one of the block
  int line = 0, file = 0;   ///< of the block
  long long executed = 0;   ///< blocks before it
  Position position{};      ///< where its motion begins, machine coordinates
  int depth_axis = -1;      ///< across the plane in force; -1: the machine has none there
  std::optional<Spindle> spindle = std::nullopt;             ///< that turns; none: it stands
  std::optional<MFunction> spindle_function = std::nullopt;  ///< M3 or M4, which the PLC was told with it
  std::optional<MFunction> coolant = std::nullopt;           ///< M7 or M8 (or another of `kCoolant`) in force
  InPosition windows = {};                                   ///< that the program has set
  bool override_effective = true;                            ///< FeedOverride in force
  std::int32_t tool = 0, corrector = 0;
  std::vector<MFunction> passed =
      {};                ///< other functions that the program gave before, the last of each code
  int writes = 0;        ///< writes into the packets that it made before
  bool signals = false;  ///< it read packets before, and their present values were taken
};

/// Runs the program without the machine up to that block. A finding, with its place, says why that cannot be
/// told: the block is never reached, an error stands before it, or the program measures before it. What comes
/// before it may read signals of the machine: they are those of `packets`, at all times.
std::variant<RestartPoint, text::Finding> restart(const Interpreter& fresh, const RestartAt& at,
                                                  const image::Packets& packets);

/// Commands that take the machine from where it stands to the point, in this order: windows, spindle,
/// coolant, the axes of the plane, then the depth axis, with an exact stop after each; straight, at
/// `feed_mm_min`. `confirm`: the program waits for the operator's start before each step.
std::vector<Command> approach(const RestartPoint& point, const Position& stands, double feed_mm_min,
                              bool confirm);

}  // namespace servogate::program
