// SPDX-License-Identifier: Apache-2.0
// Blocks as CAM systems write them, in one pass: the bulk of all long programs.
#include "kernel/program/reading/block_parts.hpp"

namespace servogate::program {
namespace {

constexpr std::uint32_t bit_of(Meaning meaning) { return std::uint32_t{1} << static_cast<unsigned>(meaning); }
constexpr std::uint32_t kWithAxis = bit_of(Meaning::axis) | bit_of(Meaning::centre_of);
constexpr std::uint32_t kPlain = kWithAxis | bit_of(Meaning::g) | bit_of(Meaning::feed) |
                                 bit_of(Meaning::radius) | bit_of(Meaning::centre_1) |
                                 bit_of(Meaning::centre_2);

/// A word that is its letter and a number, whatever the language is.
bool is_plain(const LetterRule& rule) {
  return (bit_of(rule.meaning) & kPlain) != 0 && rule.rule == nullptr &&
         (rule.axis == 0 || rule.meaning != Meaning::axis);
}

/// What may follow a number without changing it.
bool ends_number(std::string_view line, std::size_t pos) {
  return pos == line.size() || is_capital(line[pos]) || is_space(line[pos]);
}

/// A number at `pos`, as read_value() reads it; where it ends, npos: not plain. `value` lacks its column.
std::size_t plain_value(std::string_view line, std::size_t pos, Value& value) {
  const bool negative = pos < line.size() && line[pos] == '-';
  const Decimal number = read_decimal(line, pos + (negative ? 1 : 0));
  pos += number.length + (negative ? 1 : 0);
  if (number.length == 0 || !ends_number(line, pos)) return std::string_view::npos;
  value = Value{
      .number = negative ? -number.value : number.value, .negative = negative, .fraction = number.fraction};
  return pos;
}

}  // namespace

bool read_plain_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  if (line.size() > dialect.max_block_characters) return false;
  std::uint64_t met = 0;
  std::size_t pos = skip_spaces(line, 0), behind = 0, count = 0;
  std::int32_t number = -1;
  std::uint16_t number_column = 0;
  std::uint8_t g_count = 0;
  if (pos < line.size() && is_capital(line[pos]) &&
      dialect.letters[static_cast<unsigned char>(line[pos])].meaning == Meaning::number) {
    number_column = static_cast<std::uint16_t>(++pos);
    number = read_index(line, pos);
    if (number < 0 || !ends_number(line, pos)) return false;
    pos = skip_spaces(line, pos);
  }
  const std::size_t body = pos;
  for (; pos < line.size(); ++count) {
    const char c = line[pos++];
    if (!is_capital(c) || count == Block::kMaxWords) return false;
    const LetterRule& rule = dialect.letters[static_cast<unsigned char>(c)];
    const std::uint64_t bit = std::uint64_t{1} << (c - 'A');
    if (!is_plain(rule) || (met & bit) != 0) return false;
    met |= bit;
    Word& word = block.words[count];
    word.column = static_cast<std::uint16_t>(pos);
    pos = plain_value(line, pos, word.value);
    if (pos == std::string_view::npos) return false;
    if (!(word.value.number >= rule.min && word.value.number <= rule.max)) return false;
    word.value.column = static_cast<std::uint16_t>(word.column + 1);
    word.g = nullptr;
    word.rule = nullptr;
    word.letter = c;
    word.meaning = rule.meaning;
    word.axis = -1;
    word.argument_count = 0;
    behind = pos;
    pos = skip_spaces(line, pos);
    word.end = static_cast<std::uint16_t>(behind);
    if ((bit_of(rule.meaning) & kWithAxis) != 0) {
      word.axis = static_cast<std::int8_t>(axes.find(rule.axis != 0 ? rule.axis : c));
      if (word.axis < 0) return false;
    } else if (rule.meaning == Meaning::g) {
      if (word.value.fraction || word.value.negative || (count != 0 && dialect.lexis.g_first)) return false;
      word.g = dialect.find_g(static_cast<int>(word.value.number));
      if (word.g == nullptr || word.g->function == Function::later) return false;
      g_count = 1;
      // Where a list in brackets may follow, the word ends where that was looked for.
      if (dialect.lexis.bracket == Bracket::argument && pos < line.size())
        word.end = static_cast<std::uint16_t>(pos);
    }
  }
  if (count == 0) return false;
  begin_block(block, line);
  block.kind = BlockKind::words;
  block.number = number;
  block.number_column = number_column;
  block.body = body;
  block.end = behind;
  block.count = static_cast<std::uint8_t>(count);
  block.g_count = g_count;
  return true;
}

}  // namespace servogate::program
