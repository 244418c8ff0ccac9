// SPDX-License-Identifier: Apache-2.0
// Blocks as CAM systems write them, in one pass: the bulk of all long programs.
#include "kernel/program/reading/block_parts.hpp"

namespace servogate::program {
namespace {

/// A word that is its letter and a number, whatever the language is.
bool is_plain(const LetterRule& rule) {
  switch (rule.meaning) {
    case Meaning::axis:
      return rule.axis == 0;
    case Meaning::g:
    case Meaning::feed:
    case Meaning::radius:
    case Meaning::centre_1:
    case Meaning::centre_2:
    case Meaning::centre_of:
      return rule.rule == nullptr;
    default:
      return false;
  }
}

/// What may follow a number without changing it.
bool ends_number(std::string_view line, std::size_t pos) {
  return pos == line.size() || is_capital(line[pos]) || is_space(line[pos]);
}

/// The number behind a block number's letter; moves `pos` behind it. -1: not plain.
std::int32_t plain_number(std::string_view line, std::size_t& pos) {
  ++pos;
  const std::int32_t number = read_index(line, pos);
  return ends_number(line, pos) ? number : -1;
}

/// A number with its sign at `pos`, which moves behind it; false: not plain.
bool plain_value(std::string_view line, std::size_t& pos, Value& value) {
  value = Value{};
  value.column = static_cast<std::uint16_t>(pos + 1);
  if (pos < line.size() && line[pos] == '-') {
    value.negative = true;
    ++pos;
  }
  const Decimal number = read_decimal(line, pos);
  pos += number.length;
  value.number = value.negative ? -number.value : number.value;
  value.fraction = number.fraction;
  return number.length != 0 && ends_number(line, pos);
}

}  // namespace

bool read_plain_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  if (line.size() > dialect.max_block_characters) return false;
  std::int32_t block_number = -1;
  std::uint16_t number_column = 0;
  std::size_t pos = skip_spaces(line, 0), body = pos, end = 0, count = 0;
  std::uint8_t g_count = 0;
  std::uint64_t met = 0;
  for (; pos < line.size(); pos = skip_spaces(line, pos)) {
    const char c = line[pos];
    if (!is_capital(c) || count == Block::kMaxWords) return false;
    const LetterRule& rule = dialect.letters[static_cast<unsigned char>(c)];
    if (rule.meaning == Meaning::number && count == 0 && number_column == 0) {
      number_column = static_cast<std::uint16_t>(pos + 1);
      block_number = plain_number(line, pos);
      if (block_number < 0) return false;
      body = skip_spaces(line, pos);
      continue;
    }
    const std::uint64_t bit = std::uint64_t{1} << (c - 'A');
    if (!is_plain(rule) || (met & bit) != 0) return false;
    met |= bit;
    Word& word = block.words[count];
    word.letter = c;
    word.meaning = rule.meaning;
    word.axis = -1;
    word.argument_count = 0;
    word.g = nullptr;
    word.rule = nullptr;
    word.column = static_cast<std::uint16_t>(++pos);
    if (!plain_value(line, pos, word.value)) return false;
    if (!(word.value.number >= rule.min && word.value.number <= rule.max)) return false;
    end = pos;
    if (rule.meaning == Meaning::axis || rule.meaning == Meaning::centre_of) {
      word.axis = static_cast<std::int8_t>(axes.find(rule.axis != 0 ? rule.axis : c));
      if (word.axis < 0) return false;
    } else if (rule.meaning == Meaning::g) {
      if (word.value.fraction || word.value.negative || (count != 0 && dialect.lexis.g_first)) return false;
      word.g = dialect.find_g(static_cast<int>(word.value.number));
      if (word.g == nullptr || word.g->function == Function::later) return false;
      g_count = 1;
      if (dialect.lexis.bracket == Bracket::argument) pos = skip_spaces(line, pos);
    }
    word.end = static_cast<std::uint16_t>(pos);
    ++count;
  }
  if (count == 0) return false;
  block.words[count - 1].end = static_cast<std::uint16_t>(end);  // spaces at the end are no part of the block
  block.line = line;
  block.kind = BlockKind::words;
  block.sync = Sync::standard;
  block.skip = block.trailing_comment = false;
  block.skip_level = 0;
  block.number = block_number;
  block.number_column = number_column;
  block.body = body;
  block.end = end;
  block.count = static_cast<std::uint8_t>(count);
  block.g_count = g_count;
  block.argument_count = 0;
  return true;
}

}  // namespace servogate::program
