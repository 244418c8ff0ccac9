// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/block.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "kernel/program/messages.hpp"
#include "kernel/program/reading/number.hpp"

namespace servogate::program {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

bool is_letter(char c) { return is_capital(c) || (c >= 'a' && c <= 'z'); }

bool label_character(char c) { return is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 128; }

/// Cyrillic capitals (UTF-8) that look like Latin ones.
constexpr std::pair<std::string_view, std::string_view> kLookAlikes[] = {
    {"А", "A"}, {"В", "B"}, {"Е", "E"}, {"К", "K"}, {"М", "M"}, {"Н", "H"},
    {"О", "O"}, {"Р", "P"}, {"С", "C"}, {"Т", "T"}, {"У", "Y"}, {"Х", "X"}};

/// One character as it stands in the file, all bytes of a UTF-8 sequence.
std::string character_at(std::string_view line, std::size_t pos) {
  std::size_t end = pos + 1;
  while (end < line.size() && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) ++end;
  return std::string(line.substr(pos, end - pos));
}

std::size_t read_label(const Dialect& dialect, std::string_view line, std::size_t pos) {
  const std::size_t close = line.find(dialect.lexis.label_quote, pos + 1);
  if (close == std::string_view::npos) fail(Fault::label_unclosed, column(pos));
  const std::string_view label = line.substr(pos + 1, close - pos - 1);
  if (label.empty() || characters(label) > dialect.max_label_characters ||
      !std::all_of(label.begin(), label.end(), label_character))
    fail(Fault::label_bad, column(pos), {std::string(label), std::to_string(dialect.max_label_characters)});
  return close + 1;
}

std::int32_t read_number(std::string_view line, std::size_t& pos) {
  const std::size_t start = pos++;
  const int number = read_index(line, pos);
  if (number < 0 || (pos < line.size() && line[pos] == '.')) fail(Fault::number_missing_block, column(start));
  return number;
}

int prefix_rank(const Dialect& dialect, char c) {
  const Lexis& lexis = dialect.lexis;
  if (c == '\0') return 0;
  if (c == lexis.skip) return 1;
  if (c == lexis.label_quote) return 2;
  if (static_cast<unsigned char>(c) < 128 &&
      dialect.letters[static_cast<unsigned char>(c)].meaning == Meaning::number)
    return 3;
  return c == lexis.request_sync || c == lexis.cancel_sync ? 4 : 0;
}

/// The prefix `/ "LABEL" N # &` in its fixed order.
void read_prefix(const Dialect& dialect, std::string_view line, Block& block) {
  std::size_t pos = 0;
  for (int rank = 0;;) {
    pos = skip_spaces(line, pos);
    if (pos >= line.size()) break;
    const char c = line[pos];
    const int its_rank = prefix_rank(dialect, c);
    if (its_rank == 0) break;
    if (its_rank <= rank) fail(Fault::prefix_order, column(pos), {std::string(1, c)});
    rank = its_rank;
    if (its_rank == 1) {
      block.skip = true;
      ++pos;
    } else if (its_rank == 2) {
      pos = block.label_end = read_label(dialect, line, pos);
    } else if (its_rank == 3) {
      block.number_column = static_cast<std::uint16_t>(column(pos));
      block.number = read_number(line, pos);
    } else {
      block.sync = c == dialect.lexis.request_sync ? Sync::request : Sync::cancel;
      ++pos;
    }
  }
  block.body = pos;
}

void check_range(const LetterRule& rule, char letter, const Value& value) {
  if (value.number >= rule.min && value.number <= rule.max) return;
  fail(Fault::out_of_range, value.column,
       {std::string(1, letter), text::number(value.number), text::number(rule.min), text::number(rule.max)});
}

bool is_whole(Meaning m) {
  return m == Meaning::g || m == Meaning::m || m == Meaning::h || m == Meaning::tool || m == Meaning::number;
}

void check_parameter(const LetterRule& rule, char letter, const Value& value) {
  static const std::string kKinds[] = {"", "E0-E24", "E25-E29 / E30...", ""};
  if (rule.parameters == ParameterKind::any) return;
  if (rule.parameters == ParameterKind::none) fail(Fault::g_with_parameter, value.column);
  if ((rule.parameters == ParameterKind::whole) == (value.parameter < 25)) return;
  fail(Fault::parameter_type, value.column,
       {std::string(1, letter), kKinds[static_cast<int>(rule.parameters)], std::to_string(value.parameter)});
}

/// T and its corrector: the fraction is a number of its own, .1 and .10 are different correctors.
std::size_t read_tool(std::string_view line, std::size_t pos, const LetterRule& rule, Word& word,
                      Block& block) {
  const std::size_t start = pos - 1;
  const auto bad = [&] {
    std::size_t end = line.find_first_of(" \t;", start);
    end = std::min(end, line.size());
    fail(Fault::tool_form, column(start), {std::string(line.substr(start, end - start))});
  };
  const auto part = [&](Value& value) {
    value.column = static_cast<std::uint16_t>(column(pos));
    const bool parameter = pos < line.size() && line[pos] == 'E';
    if (parameter) ++pos;
    const std::size_t digits = pos;
    const int number = read_index(line, pos);
    if (number < 0 || (!parameter && pos - digits > 4)) bad();
    if (parameter) {
      value.parameter = static_cast<std::int16_t>(std::min(number, 32767));
      check_parameter(rule, 'T', value);
    } else {
      value.number = number;
    }
  };
  part(word.value);
  block.corrector = Value{};
  if (pos < line.size() && line[pos] == '.') {
    ++pos;
    part(block.corrector);
  }
  return pos;
}

void place_g(const Dialect& dialect, Word& word) {
  if (word.value.parameter >= 0) return;
  word.g = dialect.find_g(static_cast<int>(word.value.number));
  if (word.g == nullptr) fail(Fault::g_unknown, word.column, {text::number(word.value.number)});
}

/// A G word that this version does not execute may bring words of its own: it is named before them.
void name_later_g(const Block& block) {
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.meaning == Meaning::g && word.g != nullptr && word.g->function == Function::later)
      fail(Fault::not_executed, word.column, {"G" + std::to_string(word.g->number)});
  }
}

void check_conflicts(const Dialect& dialect, const Block& block) {
  for (int i = 0; i < block.count; ++i) {
    const Word& second = block.words[static_cast<std::size_t>(i)];
    if (second.g == nullptr) continue;
    for (int j = 0; j < i; ++j) {
      const Word& first = block.words[static_cast<std::size_t>(j)];
      if (first.g == nullptr) continue;
      if (first.g->group == second.g->group || dialect.conflict(first.g->number, second.g->number))
        fail(Fault::g_conflict, second.column,
             {std::to_string(first.g->number), std::to_string(second.g->number)});
    }
  }
  name_later_g(block);
}

/// A run of letters, digits and points: what a person takes for one word.
std::string run_at(std::string_view line, std::size_t pos) {
  std::size_t end = pos + 1;
  while (end < line.size() && (is_digit(line[end]) || line[end] == '.' || is_letter(line[end]))) ++end;
  return std::string(line.substr(pos, end - pos));
}

/// What a person means who writes 1,5.
std::string comma_hint(std::string_view line, std::size_t pos) {
  const bool comma = line[pos] == ',' && pos + 1 < line.size() && is_digit(line[pos + 1]);
  return comma ? text::both(": numbers have a decimal point, not a comma",
                            ": в числах пишется десятичная точка, а не запятая")
               : std::string();
}

[[noreturn]] void fail_letter(const Dialect& dialect, const Block& block, std::size_t pos) {
  const std::string_view line = block.line;
  name_later_g(block);
  const char c = line[pos];
  if (!is_letter(c)) {
    const std::string character = character_at(line, pos);
    for (const auto& [cyrillic, latin] : kLookAlikes)
      if (character == cyrillic) fail(Fault::cyrillic, column(pos), {character, std::string(latin)});
    fail(Fault::unknown_character, column(pos), {character, comma_hint(line, pos)});
  }
  const std::string run = run_at(line, pos);
  const bool meant =
      dialect.letters[static_cast<unsigned char>(in_capitals(run)[0]) & 127u].meaning != Meaning::unknown;
  fail(Fault::unknown_word, column(pos), {run, capitals_hint(run, meant)});
}

/// A letter alone is 0, where 0 is possible; one with letters behind it that are no words is none.
void check_bare(const Dialect& dialect, const LetterRule& rule, const Block& block, const Word& word,
                std::size_t pos) {
  const std::string_view line = block.line;
  const bool letters = pos < block.end && is_letter(line[pos]) &&
                       dialect.letters[static_cast<unsigned char>(line[pos])].meaning == Meaning::unknown;
  if (!letters && rule.min <= 0.0 && rule.max >= 0.0) return;
  name_later_g(block);
  fail(Fault::value_missing, word.column,
       {std::string(1, word.letter), run_at(line.substr(0, block.end), word.column - 1u)});
}

/// Classes of words already met in a block, for order and repetition.
struct Met {
  std::uint64_t letters = 0;  ///< bit of a letter: c - 'A', up to 'z' (57)
  std::uint64_t twice = 0;
  int m_words = 0;
  const Word* operand = nullptr;
};

void check_word(const Dialect& dialect, Block& block, Word& word, Met& met) {
  if (word.meaning == Meaning::g) {
    ++block.g_count;
    place_g(dialect, word);
    if (met.operand != nullptr)
      fail(Fault::g_after_operand, word.column,
           {word.value.parameter >= 0 ? "E" + std::to_string(word.value.parameter)
                                      : text::number(word.value.number),
            word_text(block, *met.operand)});
    return;
  }
  const bool operand = word.meaning >= Meaning::axis && word.meaning <= Meaning::radius;
  if (operand) met.operand = &word;
  if (word.meaning == Meaning::m) {
    if (++met.m_words > dialect.max_m_words)
      fail(Fault::m_too_many, word.column,
           {std::to_string(met.m_words), std::to_string(dialect.max_m_words)});
    return;
  }
  const std::uint64_t bit = std::uint64_t{1} << (word.letter - 'A');
  const bool again = (met.letters & bit) != 0;
  const bool allowed =
      dialect.letters[static_cast<unsigned char>(word.letter)].twice && (met.twice & bit) == 0;
  if (again && !allowed) fail(Fault::word_twice, word.column, {std::string(1, word.letter)});
  if (again) met.twice |= bit;
  met.letters |= bit;
}

/// One word of the block; returns the offset behind it.
std::size_t read_word(const Dialect& dialect, const AxisLetters& axes, Block& block, std::size_t pos,
                      Word& word) {
  const std::string_view line = block.line;
  const char c = line[pos];
  if (static_cast<unsigned char>(c) >= 128) fail_letter(dialect, block, pos);
  const LetterRule& rule = dialect.letters[static_cast<unsigned char>(c)];
  if (rule.meaning == Meaning::unknown) fail_letter(dialect, block, pos);
  word.letter = c;
  word.meaning = rule.meaning;
  word.column = static_cast<std::uint16_t>(column(pos));
  word.axis = -1;
  word.g = nullptr;
  if (rule.meaning == Meaning::number) fail(Fault::prefix_order, word.column, {"N"});
  if (rule.meaning == Meaning::axis) {
    word.axis = static_cast<std::int8_t>(axes.find(c));
    if (word.axis < 0) fail(Fault::axis_missing, word.column, {std::string(1, c)});
  }
  ++pos;
  if (rule.meaning == Meaning::tool) {
    word.value = Value{};
    return read_tool(line, pos, rule, word, block);
  }
  const std::string_view name(&line[pos - 1], 1);
  word.value = read_value(line, pos, name);
  if (rule.meaning == Meaning::later) {
    name_later_g(block);
    fail(Fault::not_executed, word.column,
         {std::string(line.substr(word.column - 1u, pos - word.column + 1u))});
  }
  if (word.value.parameter >= 0) {
    check_parameter(rule, c, word.value);
  } else {
    if (word.value.bare) check_bare(dialect, rule, block, word, pos);
    if (is_whole(rule.meaning) && (word.value.fraction || word.value.negative))
      fail(Fault::whole_number, word.value.column,
           {std::string(name),
            std::string(line.substr(word.value.column - 1u, pos - word.value.column + 1u))});
    check_range(rule, c, word.value);
  }
  return pos;
}

/// Offset behind spaces and, where brackets are comments, behind those (they nest).
std::size_t skip_comments(const Dialect& dialect, const Block& block, std::size_t pos) {
  pos = skip_spaces(block.line, pos);
  while (dialect.lexis.bracket == Bracket::comment && pos < block.end && block.line[pos] == '(') {
    const std::size_t open = pos;
    int depth = 0;
    do {
      if (pos == block.end) fail(Fault::bracket_unclosed, column(open));
      depth += block.line[pos] == '(' ? 1 : block.line[pos] == ')' ? -1 : 0;
      ++pos;
    } while (depth > 0);
    pos = skip_spaces(block.line, pos);
  }
  return pos;
}

void read_words(const Dialect& dialect, const AxisLetters& axes, Block& block) {
  Met met;
  for (std::size_t pos = skip_comments(dialect, block, block.body); pos < block.end;) {
    if (block.count == Block::kMaxWords)
      fail(Fault::too_many_words, column(pos), {std::to_string(Block::kMaxWords)});
    Word& word = block.words[block.count];
    pos = skip_comments(dialect, block, read_word(dialect, axes, block, pos, word));
    ++block.count;
    check_word(dialect, block, word, met);
  }
  if (block.g_count > 0) check_conflicts(dialect, block);
}

/// Offset of a comment that follows words, or the end of the line; says which kind of block stands here.
void classify(const Lexis& lexis, Block& block) {
  const std::string_view line = block.line;
  block.end = line.size();
  const bool code = lexis.bracket == Bracket::code && line[block.body] == '(';
  block.kind = code ? BlockKind::code : BlockKind::words;
  bool quoted = false;
  for (std::size_t i = block.body; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '=' && block.kind == BlockKind::words) block.kind = BlockKind::assignments;
    if (c == lexis.comment && c != '\0') {
      block.end = i;
      block.trailing_comment = true;
      break;
    }
  }
  if (quoted) fail(Fault::string_unclosed, column(line.rfind('"')));
  while (block.end > block.body && is_space(line[block.end - 1])) --block.end;
}

}  // namespace

AxisLetters::AxisLetters(const std::vector<std::string>& letters) : AxisLetters() {
  for (std::size_t i = 0; i < letters.size(); ++i)
    if (letters[i].size() == 1 && static_cast<unsigned char>(letters[i][0]) < 128)
      index_[static_cast<unsigned char>(letters[i][0])] = static_cast<std::int8_t>(i);
}

const Word* Block::find(Meaning meaning) const noexcept {
  for (std::size_t i = 0; i < count; ++i)
    if (words[i].meaning == meaning) return &words[i];
  return nullptr;
}

int column_of(const Block& block, int axis) noexcept {
  if (axis >= 0 && block.kind == BlockKind::words)
    for (std::size_t i = 0; i < block.count; ++i)
      if (block.words[i].axis == axis) return block.words[i].column;
  return column(block.body);
}

std::string word_text(const Block& block, const Word& word) {
  std::size_t end = word.column;
  while (end < block.end && !is_letter(block.line[end]) && !is_space(block.line[end])) ++end;
  if (word.value.parameter >= 0)
    return std::string(1, word.letter) + (word.value.negative ? "-E" : "E") +
           std::to_string(word.value.parameter);
  return std::string(block.line.substr(word.column - 1u, end - word.column + 1u));
}

Value read_value(std::string_view line, std::size_t& pos, std::string_view word) {
  Value value;
  std::size_t at = skip_spaces(line, pos);
  const bool sign = at < line.size() && (line[at] == '-' || line[at] == '+');
  value.column = static_cast<std::uint16_t>(column(at));
  if (sign) {
    value.negative = line[at] == '-';
    at = skip_spaces(line, at + 1);
  }
  if (at < line.size() && line[at] == 'E') {
    ++at;
    const int index = read_index(line, at);
    if (index < 0) fail(Fault::parameter_number_missing, column(at));
    value.parameter = static_cast<std::int16_t>(std::min(index, 32767));
    pos = at;
    return value;
  }
  const Decimal number = read_decimal(line, at);
  if (number.length == 0) {
    if (sign)
      fail(Fault::expected, column(at),
           {text::both("number after " + std::string(word), "число после " + std::string(word))});
    value.bare = true;
    return value;
  }
  value.number = value.negative ? -number.value : number.value;
  value.fraction = number.fraction;
  pos = at + number.length;
  return value;
}

void read_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  block.line = line;
  block.kind = BlockKind::empty;
  block.sync = Sync::standard;
  block.skip = block.trailing_comment = false;
  block.number = -1;
  block.label_end = 0;
  block.count = block.g_count = 0;
  const std::size_t first = skip_spaces(line, 0);
  if (first == line.size() || line[first] == dialect.lexis.comment || line[first] == dialect.lexis.tape)
    return;
  if (line.size() > dialect.max_block_characters &&
      (characters(line) > dialect.max_block_characters || line.size() > 4 * dialect.max_block_characters))
    fail(Fault::block_too_long, static_cast<int>(dialect.max_block_characters) + 1,
         {std::to_string(characters(line)), std::to_string(dialect.max_block_characters)});
  read_prefix(dialect, line, block);
  if (block.body >= line.size()) return;
  classify(dialect.lexis, block);
  if (block.body >= block.end) {
    block.kind = BlockKind::empty;
    return;
  }
  if (block.kind == BlockKind::words) read_words(dialect, axes, block);
}

}  // namespace servogate::program
