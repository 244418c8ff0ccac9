// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/program/reading/dialect.hpp"
#include "kernel/program/values/number.hpp"

namespace servogate::program {

/// Axis index by letter, -1 where the machine has none.
class AxisLetters {
 public:
  AxisLetters() { index_.fill(-1); }
  explicit AxisLetters(const std::vector<std::string>& letters);
  int find(char letter) const noexcept {
    return static_cast<unsigned char>(letter) < 128 ? index_[static_cast<unsigned char>(letter)] : -1;
  }

 private:
  std::array<std::int8_t, 128> index_{};
};

/// Whether a coordinate counts from zero or from the last one.
enum class Dimension : std::uint8_t { as_modes, absolute, incremental };

/// The number of a word: written out, a parameter that stands for it, or an expression.
struct Value {
  double number = 0.0;
  std::int16_t parameter = -1;
  std::uint16_t column = 0;      ///< of the number itself, from 1
  std::uint16_t expression = 0;  ///< offset of an expression in the line, plus 1; 0: none
  bool negative : 1 = false;     ///< a minus stands before it (kept for -0 and for parameters)
  bool fraction : 1 = false;     ///< a point was written
  bool bare : 1 = false;         ///< nothing was written: 0
  Dimension dimension : 2 = Dimension::as_modes;
};

/// One word of a block.
struct Word {
  const GRule* g = nullptr;        ///< of a G word whose number is written out
  const WordRule* rule = nullptr;  ///< of a named word or a statement
  Value value;
  char letter = 0;  ///< 0: it has a name
  Meaning meaning = Meaning::unknown;
  std::int8_t axis = -1;
  std::uint8_t argument_count = 0;  ///< of its list in brackets, in Block::arguments
  std::uint16_t column = 0;
  std::uint16_t end = 0;  ///< offset behind it
  std::uint16_t text_begin = 0,
                text_end = 0;  ///< offsets of a label, a name, of what a statement reads itself
};

enum class Sync : std::uint8_t { standard, request, cancel };
enum class BlockKind : std::uint8_t { empty, words, own_form };

/// One line, taken apart. Views point into the line.
struct Block {
  static constexpr std::size_t kMaxWords = 32;
  static constexpr std::size_t kMaxArguments = 20;

  std::string_view line;
  BlockKind kind = BlockKind::empty;
  Sync sync = Sync::standard;
  bool skip = false;            ///< a skip mark stands in front
  std::uint8_t skip_level = 0;  ///< its digit
  /// Bit of each level that is left out where such a mark stands anywhere; whoever reads the block sets it.
  std::uint16_t levels_left_out = 0;
  bool trailing_comment = false;
  std::int32_t number = -1;  ///< N
  std::uint16_t number_column = 0;
  std::size_t body = 0;  ///< offset of what follows the prefix
  std::size_t end = 0;   ///< offset of a trailing comment, or the length of the line
  std::uint8_t count = 0;
  std::uint8_t g_count = 0;
  std::uint8_t argument_count = 0;
  Value corrector;  ///< of a tool word that brings one
  std::array<Word, kMaxWords> words;
  std::array<Value, kMaxArguments> arguments;  ///< of the one word that has a list

  const Word* find(Meaning meaning) const noexcept;
  std::string_view text(const Word& word) const noexcept {
    return line.substr(word.text_begin, word.text_end - word.text_begin);
  }
};

/// Where a word's own reader stands.
struct BlockText {
  const Dialect& dialect;
  const AxisLetters& axes;
  Block& block;
  std::string_view line;  ///< up to the end of the block
  std::size_t pos;        ///< behind the name of the word; the reader moves it behind what it takes

  int column() const noexcept { return static_cast<int>(pos) + 1; }
  char peek() noexcept {
    pos = skip_spaces(line, pos);
    return pos < line.size() ? line[pos] : '\0';
  }
  /// Takes a character that has to stand here.
  void expect(char c);
  /// Takes what stands in brackets from here on as an expression; the brackets belong to it.
  void bracketed(Value& value);
  /// Takes an expression from here on, as far as it goes.
  void expression(Value& value);
};

/// Takes a line apart by the rules of a language; `block` is reused from line to line and nothing is
/// allocated. Throws ProgramError. Words whose meaning depends on modes are not judged here.
void read_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block);

/// Reads a sign and a number, or what stands for one, and moves the text behind it. `word` names it in
/// messages.
Value read_value(BlockText& text, std::string_view word);

/// Throws where no such parameter may stand for a number. `word` names it in messages.
void check_parameter(const Dialect& dialect, ParameterKind kind, std::string_view word, const Value& value);

/// Offset behind the skip mark, the block number and a label in colon form, where they stand; the number goes
/// to `number` (unchanged where none stands) and the label to `label`.
std::size_t skip_prefix(const Dialect& dialect, std::string_view line, std::int32_t& number,
                        std::string_view& label) noexcept;

/// True for a line that holds no block: blank, a comment, or its first character says so.
bool holds_nothing(const Lexis& lexis, std::string_view line, std::size_t first) noexcept;

/// Column of the first word of an axis, or of what follows the prefix when there is none (axis -1: always).
int column_of(const Block& block, int axis) noexcept;

/// How a word reads in messages: its letter and number as written.
std::string word_text(const Dialect& dialect, const Block& block, const Word& word);

}  // namespace servogate::program
