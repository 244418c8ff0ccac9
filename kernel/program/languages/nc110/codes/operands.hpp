// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "kernel/program/reading/block.hpp"

namespace servogate::program::nc110 {

struct Operands;

/// A three-letter code. `operands` is its signature, one character an operand: n number, x value, a axis, v
/// axis with a value, p axis with two values, l label, c comparison side, i display item, w wait condition, .
/// anything, k axis or K with a value, f program name; + after it: one or more, * : any number; everything
/// after ? may be missing. `run` null: not executed in this version.
struct CodeRule {
  std::string_view name;
  std::string_view operands;
  void (*run)(Execution&, const Operands&);
  bool in_contour = true;  ///< may stand inside of a compensated contour or a profile
};

/// All codes of the language.
std::span<const CodeRule> codes();

/// One operand of a code, read by its place in the signature (CodeRule::operands).
struct Operand {
  char kind = 0;
  int axis = -1;          ///< of a, v and p
  std::size_t begin = 0;  ///< offsets in the line, without surrounding spaces
  std::size_t end = 0;
  Value value;   ///< of n, x, v and p
  Value second;  ///< of p
};

/// A three-letter code with its operands.
struct Operands {
  static constexpr std::size_t kMax = 24;

  Block* block = nullptr;
  const CodeRule* rule = nullptr;
  int column = 1;  ///< of the code itself
  std::size_t count = 0;
  std::array<Operand, kMax> items;

  std::string_view text(const Operand& item) const {
    return block->line.substr(item.begin, item.end - item.begin);
  }
  const Operand* begin() const { return items.data(); }
  const Operand* end() const { return items.data() + count; }
};

/// Reads a block in brackets. Throws ProgramError; an operand's value is not evaluated here.
void read_operands(const Dialect& dialect, const AxisLetters& axes, Block& block, Operands& out);

}  // namespace servogate::program::nc110
