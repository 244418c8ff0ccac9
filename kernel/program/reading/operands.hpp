// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "kernel/program/reading/block.hpp"

namespace servogate::program {

/// One operand of a three-letter code, read by its place in the signature (CodeRule::operands).
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

  const Block* block = nullptr;
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

/// Reads a block of kind BlockKind::code. Throws ProgramError; an operand's value is not evaluated here.
void read_operands(const Dialect& dialect, const AxisLetters& axes, const Block& block, Operands& out);

/// True when the text names a place of SA or SK outside of quotes from `pos` on.
bool names_signal(std::string_view text, std::size_t pos);

}  // namespace servogate::program
