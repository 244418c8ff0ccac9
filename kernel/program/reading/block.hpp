// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/program/reading/dialect.hpp"

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

/// The number of a word: written out, or a parameter that stands for it.
struct Value {
  double number = 0.0;
  std::int16_t parameter = -1;
  std::uint16_t column = 0;  ///< of the number itself, from 1
  bool negative = false;     ///< a minus stands before it (kept for -0 and for parameters)
  bool fraction = false;     ///< a point was written
  bool bare = false;         ///< nothing was written: 0
};

/// One word of a block.
struct Word {
  char letter = 0;
  Meaning meaning = Meaning::unknown;
  std::int8_t axis = -1;
  std::uint16_t column = 0;
  Value value;
  const GRule* g = nullptr;  ///< of a G word whose number is written out
};

enum class Sync : std::uint8_t { standard, request, cancel };
enum class BlockKind : std::uint8_t { empty, words, assignments, code };

/// One line, taken apart. Views point into the line.
struct Block {
  static constexpr std::size_t kMaxWords = 32;

  std::string_view line;
  BlockKind kind = BlockKind::empty;
  Sync sync = Sync::standard;
  bool skip = false;  ///< `/` stands in front
  bool trailing_comment = false;
  std::int32_t number = -1;  ///< N
  std::uint16_t number_column = 0;
  std::size_t label_end = 0;  ///< offset behind the label, 0: no label
  std::size_t body = 0;       ///< offset of what follows the prefix
  std::size_t end = 0;        ///< offset of a trailing comment, or the length of the line
  std::uint8_t count = 0;
  std::uint8_t g_count = 0;
  Value corrector;  ///< fraction of the T word, as a whole number
  std::array<Word, kMaxWords> words;

  const Word* find(Meaning meaning) const noexcept;
};

/// Takes a line apart by the rules of a language; `block` is reused from line to line and nothing is
/// allocated. Throws ProgramError. Words whose meaning depends on modes are not judged here.
void read_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block);

/// Reads a sign and a number or a parameter at `pos` and moves `pos` behind it. `word` names it in messages.
Value read_value(std::string_view line, std::size_t& pos, std::string_view word);

/// Column of the first word of an axis, or of what follows the prefix when there is none (axis -1: always).
int column_of(const Block& block, int axis) noexcept;

/// How a word reads in messages: its letter and number as written.
std::string word_text(const Block& block, const Word& word);

inline std::size_t skip_spaces(std::string_view text, std::size_t pos) noexcept {
  while (pos < text.size() && (text[pos] == ' ' || text[pos] == '\t' || text[pos] == '\r')) ++pos;
  return pos;
}

}  // namespace servogate::program
