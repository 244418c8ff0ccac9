// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string_view>

#include "kernel/program/reading/block.hpp"

/// The parts of a block as block.cpp puts them together.
namespace servogate::program {

/// A letter, a digit or _.
inline bool name_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }
/// Throws: `c` belongs to the prefix and does not stand in its order.
[[noreturn]] void fail_prefix(const Dialect& dialect, int column, char c);
/// A block of this line, without anything read of it.
inline void begin_block(Block& block, std::string_view line) {
  block.line = line;
  block.kind = BlockKind::empty;
  block.sync = Sync::standard;
  block.skip = block.trailing_comment = false;
  block.skip_level = 0;
  block.number = -1;
  block.number_column = 0;
  block.count = block.g_count = block.argument_count = 0;
}
/// A block of a number, at most one G word and words whose numbers are written out, each letter once, as
/// read_any_block() would read it, only sooner. False: it is another one, or a wrong one; `block` means
/// nothing then. Never throws.
bool read_plain_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block);
/// Every block, and what is wrong with one.
void read_any_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block);
/// Block number, label and the like in their fixed order; the body begins behind them.
void read_prefix(const Dialect& dialect, std::string_view line, Block& block);
/// The digit behind a skip mark, 0 where none stands; `pos` at the mark, moved behind both.
std::uint8_t read_skip_level(const Lexis& lexis, std::string_view line, std::size_t& pos);
/// The words of the body, each judged by its rule and against those before it.
void read_words(const Dialect& dialect, const AxisLetters& axes, Block& block);

}  // namespace servogate::program
