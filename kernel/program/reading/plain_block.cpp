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
bool ends_number(const char* at, const char* end) { return at == end || is_capital(*at) || is_space(*at); }

/// A number at `at` as read_value() reads it; where it ends, null: not plain. `value` lacks its column.
const char* plain_value(const char* at, const char* const end, Value& value) {
  static constexpr double kPower[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                      1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool negative = at != end && *at == '-';
  at += negative ? 1 : 0;
  const char* const begin = at;
  const char* const last = end - at > 16 ? at + 16 : end;  // 15 digits are exact
  std::int64_t mantissa = 0;
  const auto digits = [&] {
    for (unsigned digit; at != last && (digit = static_cast<unsigned char>(*at) - unsigned{'0'}) <= 9; ++at)
      mantissa = mantissa * 10 + digit;
  };
  digits();
  std::ptrdiff_t count = at - begin, decimals = 0;
  const bool fraction = at != last && *at == '.';
  if (fraction) {
    const char* const point = at++;
    digits();
    decimals = at - point - 1;
    count += decimals;
  }
  if (count == 0 || count > 15 || !ends_number(at, end)) return nullptr;
  const double number = static_cast<double>(mantissa) / kPower[decimals];
  value = Value{.number = negative ? -number : number, .negative = negative, .fraction = fraction};
  return at;
}

}  // namespace

bool read_plain_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  if (line.size() > dialect.max_block_characters) return false;
  const char* const begin = line.data();
  const char* const end = begin + line.size();
  const char* at = begin;
  const auto spaces = [&] {
    while (at != end && is_space(*at)) ++at;
  };
  const auto offset = [&] { return static_cast<std::size_t>(at - begin); };
  std::uint64_t met = 0;
  std::size_t body = 0, behind = 0, count = 0;
  std::int32_t number = -1;
  std::uint16_t number_column = 0;
  std::uint8_t g_count = 0;
  spaces();
  if (at != end && is_capital(*at) &&
      dialect.letters[static_cast<unsigned char>(*at)].meaning == Meaning::number) {
    std::size_t pos = offset() + 1;
    number_column = static_cast<std::uint16_t>(pos);
    number = read_index(line, pos);
    at = begin + pos;
    if (number < 0 || !ends_number(at, end)) return false;
    spaces();
  }
  body = offset();
  for (; at != end; ++count) {
    const char c = *at++;
    if (!is_capital(c) || count == Block::kMaxWords) return false;
    const LetterRule& rule = dialect.letters[static_cast<unsigned char>(c)];
    const std::uint64_t bit = std::uint64_t{1} << (c - 'A');
    if (!is_plain(rule) || (met & bit) != 0) return false;
    met |= bit;
    Word& word = block.words[count];
    const auto column = static_cast<std::uint16_t>(offset());
    at = plain_value(at, end, word.value);
    if (at == nullptr || !(word.value.number >= rule.min && word.value.number <= rule.max)) return false;
    word.value.column = static_cast<std::uint16_t>(column + 1);
    word.g = nullptr;
    word.rule = nullptr;
    word.letter = c;
    word.meaning = rule.meaning;
    word.axis = -1;
    word.argument_count = 0;
    word.column = column;
    behind = offset();
    spaces();
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
      if (dialect.lexis.bracket == Bracket::argument && at != end)
        word.end = static_cast<std::uint16_t>(offset());
    }
  }
  if (count == 0) return false;
  block.line = line;
  block.kind = BlockKind::words;
  block.sync = Sync::standard;
  block.skip = block.trailing_comment = false;
  block.skip_level = 0;
  block.number = number;
  block.number_column = number_column;
  block.body = body;
  block.end = behind;
  block.count = static_cast<std::uint8_t>(count);
  block.g_count = g_count;
  block.argument_count = 0;
  return true;
}

}  // namespace servogate::program
