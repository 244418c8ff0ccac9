// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/reading/block_parts.hpp"

namespace servogate::program {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

/// One character as it stands in the file, all bytes of a UTF-8 sequence.
std::string character_at(std::string_view line, std::size_t pos) {
  std::size_t end = pos + 1;
  while (end < line.size() && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) ++end;
  return std::string(line.substr(pos, end - pos));
}

void check_range(const LetterRule& rule, char letter, const Value& value) {
  if (value.number >= rule.min && value.number <= rule.max) return;
  fail(Fault::out_of_range, value.column,
       {std::string(1, letter), text::number(value.number), text::number(rule.min), text::number(rule.max)});
}

bool is_whole(Meaning m) {
  return m == Meaning::g || m == Meaning::m || m == Meaning::h || m == Meaning::tool ||
         m == Meaning::number || m == Meaning::corrector;
}

void place_g(const Dialect& dialect, Word& word) {
  if (word.value.parameter >= 0 || word.value.expression != 0) return;
  word.g = dialect.find_g(static_cast<int>(word.value.number));
  if (word.g == nullptr) fail(Fault::g_unknown, word.column, {g_name(static_cast<int>(word.value.number))});
}

/// A G word that this version does not execute may bring words of its own: it is named before them.
void name_later_g(const Block& block) {
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.meaning == Meaning::g && word.g != nullptr && word.g->function == Function::later)
      fail(Fault::not_executed, word.column, {"G" + g_name(word.g->number)});
  }
}

void check_conflicts(const Dialect& dialect, const Block& block) {
  for (int i = 0; i < block.count; ++i) {
    const Word& second = block.words[static_cast<std::size_t>(i)];
    if (second.g == nullptr) continue;
    for (int j = 0; j < i; ++j) {
      const Word& first = block.words[static_cast<std::size_t>(j)];
      if (first.g == nullptr) continue;
      const bool replaced = dialect.last_mode_counts && first.g->function != Function::own &&
                            second.g->function != Function::own;
      if ((first.g->group == second.g->group && !replaced) ||
          dialect.conflict(first.g->number, second.g->number))
        fail(Fault::g_conflict, second.column, {g_name(first.g->number), g_name(second.g->number)});
    }
  }
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
    fail(Fault::unknown_character, column(pos), {character, comma_hint(line, pos)});
  }
  const std::string run = run_at(line, pos);
  const bool meant =
      dialect.letters[static_cast<unsigned char>(in_capitals(run)[0]) & 127u].meaning != Meaning::unknown;
  fail(Fault::unknown_word, column(pos), {run, capitals_hint(run, meant)});
}

/// No word begins at `pos` for a person: a letter that is none, or one that is not executed and has no
/// number.
bool is_no_word(const Dialect& dialect, std::string_view line, std::size_t pos) {
  if (pos >= line.size() || !is_letter(line[pos])) return false;
  const Meaning meaning = dialect.letters[static_cast<unsigned char>(line[pos])].meaning;
  return meaning == Meaning::unknown ||
         (meaning == Meaning::later && pos + 1 < line.size() && is_letter(line[pos + 1]));
}

/// A letter alone is 0 in some languages, where 0 is possible; one with letters behind it that are no words
/// is none.
void check_bare(const Dialect& dialect, const LetterRule& rule, const Block& block, const Word& word,
                std::size_t pos) {
  const std::string_view line = block.line;
  const bool letters = is_no_word(dialect, line.substr(0, block.end), pos);
  const bool zero = dialect.lexis.bare_is_zero || (rule.meaning == Meaning::axis && rule.bare);
  if (zero && !letters && rule.min <= 0.0 && rule.max >= 0.0) return;
  name_later_g(block);
  fail(Fault::value_missing, word.column,
       {std::string(1, word.letter), run_at(line.substr(0, block.end), word.column - 1u)});
}

/// Classes of words already met in a block, for order and repetition.
struct Met {
  std::uint64_t letters = 0;  ///< bit of a letter: c - 'A', up to 'z' (57)
  std::uint64_t twice = 0;
  int m_words = 0;
  bool later_g = false;
  const Word* operand = nullptr;
};

void check_word(const Dialect& dialect, Block& block, Word& word, Met& met) {
  if (word.meaning == Meaning::g) {
    ++block.g_count;
    place_g(dialect, word);
    met.later_g = met.later_g || (word.g != nullptr && word.g->function == Function::later);
    if (met.operand != nullptr && dialect.lexis.g_first)
      fail(Fault::g_after_operand, word.column,
           {word.value.parameter >= 0 ? dialect.parameters.name_of(word.value.parameter)
                                      : text::number(word.value.number),
            word_text(dialect, block, *met.operand)});
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
  if (word.meaning == Meaning::statement) return;
  if (word.letter == 0) {
    const auto same = [&](const Word& other) { return &other != &word && other.rule == word.rule; };
    if (std::any_of(block.words.begin(), block.words.begin() + block.count, same))
      fail(Fault::word_twice, word.column, {std::string(word.rule->name)});
    return;
  }
  const std::uint64_t bit = std::uint64_t{1} << (word.letter - 'A');
  const bool again = (met.letters & bit) != 0;
  const LetterRule& rule = dialect.letters[static_cast<unsigned char>(word.letter)];
  const bool allowed = rule.many || (rule.twice && (met.twice & bit) == 0);
  if (again && !allowed) fail(Fault::word_twice, word.column, {std::string(1, word.letter)});
  if (again) met.twice |= bit;
  met.letters |= bit;
}

/// The list in brackets behind a G word: numbers and expressions, any of them left out.
void read_arguments(BlockText& text, Word& word) {
  const std::string_view line = text.line;
  ++text.pos;
  for (;;) {
    if (text.block.argument_count == Block::kMaxArguments)
      fail(Fault::arguments_many, text.column(),
           {word_text(text.dialect, text.block, word), std::to_string(Block::kMaxArguments)});
    Value& value = text.block.arguments[text.block.argument_count++];
    ++word.argument_count;
    value = Value{};
    const char c = text.peek();
    value.column = static_cast<std::uint16_t>(text.column());
    value.bare = c == ',' || c == ')';
    if (!value.bare) text.expression(value);
    if (text.peek() == ')') break;
    if (text.pos == line.size()) fail(Fault::bracket_unclosed, word.column);
    text.expect(',');
  }
  ++text.pos;
}

/// G07.1: a number of its own.
void read_g_point(Word& word) {
  const double whole = std::floor(word.value.number), digit = (word.value.number - whole) * 10.0;
  if (whole < kPointInG && std::abs(digit - std::round(digit)) < 1e-6 && !word.value.negative) {
    word.value.number = whole + kPointInG * std::round(digit);
    word.value.fraction = false;
  }
}

/// The number of a plain word: judged here where it is written out.
void read_plain(BlockText& text, const LetterRule& rule, Word& word) {
  const std::size_t start = word.column - 1u;
  const std::string_view name(&text.line[start], 1);
  word.value = read_value(text, name);
  if (rule.meaning == Meaning::later) {
    name_later_g(text.block);
    fail(Fault::not_executed, word.column, {std::string(text.line.substr(start, text.pos - start))});
  }
  if (word.value.expression != 0) return;
  if (word.value.parameter >= 0) return check_parameter(text.dialect, rule.parameters, name, word.value);
  if (word.value.bare && (!rule.bare || rule.meaning == Meaning::axis))
    check_bare(text.dialect, rule, text.block, word, text.pos);
  if (rule.meaning == Meaning::g && word.value.fraction && text.dialect.lexis.point_in_g) read_g_point(word);
  if (is_whole(rule.meaning) && (word.value.fraction || word.value.negative))
    fail(Fault::whole_number, word.value.column,
         {std::string(name),
          std::string(text.line.substr(word.value.column - 1u, text.pos - word.value.column + 1u))});
  check_range(rule, word.letter, word.value);
}

int axis_of(const BlockText& text, char letter, int column) {
  const int axis = text.axes.find(letter);
  if (axis < 0) fail(Fault::axis_missing, column, {std::string(1, letter)});
  return axis;
}

/// What the rule of a statement or a named word reads.
void read_by_rule(BlockText& text, Word& word) {
  const WordRule& rule = *word.rule;
  if (rule.meaning == Meaning::statement && rule.run == nullptr && rule.motion == nullptr) {
    name_later_g(text.block);
    fail(Fault::not_executed, word.column, {std::string(rule.name)});
  }
  if (rule.read != nullptr) return rule.read(text, word);
  if (rule.meaning == Meaning::statement) return;
  text.expect('=');
  text.expression(word.value);
}

/// A word with a name of two letters or more; false: a single letter stands here.
bool read_named(BlockText& text, Word& word) {
  const std::string_view line = text.line;
  const std::size_t start = text.pos;
  const auto begins = [&](std::size_t i) {
    return i < line.size() && (is_letter(line[i]) || line[i] == '_');
  };
  if (!begins(start) || !begins(start + 1)) return false;
  std::size_t end = start;
  while (end < line.size() && name_character(line[end])) ++end;
  const std::string_view name = line.substr(start, end - start);
  word.rule = text.dialect.find_word(name);
  if (word.rule == nullptr) word.rule = text.dialect.find_word({});
  if (word.rule == nullptr) fail(Fault::unknown_word, column(start), {std::string(name), {}});
  word.meaning = word.rule->meaning;
  word.text_begin = static_cast<std::uint16_t>(start);
  word.text_end = static_cast<std::uint16_t>(end);
  text.pos = end;
  if (word.rule->axis != 0) word.axis = static_cast<std::int8_t>(axis_of(text, word.rule->axis, word.column));
  read_by_rule(text, word);
  return true;
}

/// One word of the block; the text stands behind it then.
void read_word(BlockText& text, Word& word) {
  const Dialect& dialect = text.dialect;
  const std::size_t start = text.pos;
  word.letter = 0;
  word.axis = -1;
  word.argument_count = 0;
  word.g = nullptr;
  word.rule = nullptr;
  word.column = static_cast<std::uint16_t>(column(start));
  if (dialect.lexis.named_words) {
    word.value = Value{};
    if (read_named(text, word)) return;
  }
  const char c = dialect.lexis.named_words ? capital(text.line[start]) : text.line[start];
  if (static_cast<unsigned char>(c) >= 128) fail_letter(dialect, text.block, start);
  const LetterRule& rule = dialect.letters[static_cast<unsigned char>(c)];
  if (rule.meaning == Meaning::unknown) fail_letter(dialect, text.block, start);
  word.letter = c;
  word.meaning = rule.meaning;
  if (rule.meaning == Meaning::number) fail_prefix(dialect, word.column, c);
  const char axis = rule.axis != 0 ? rule.axis : c;
  if (rule.meaning == Meaning::axis)
    word.axis =
        static_cast<std::int8_t>(rule.other ? text.axes.find(axis) : axis_of(text, axis, word.column));
  if (rule.meaning == Meaning::centre_of)
    word.axis = static_cast<std::int8_t>(rule.many ? text.axes.find(rule.axis)
                                                   : axis_of(text, rule.axis, word.column));
  ++text.pos;
  if (rule.rule != nullptr) {
    word.rule = rule.rule;
    word.value = Value{};
    return read_by_rule(text, word);
  }
  read_plain(text, rule, word);
  if (rule.meaning == Meaning::axis && rule.axis != 0) word.value.dimension = Dimension::incremental;
  if (dialect.lexis.bracket == Bracket::argument && rule.meaning == Meaning::g && text.peek() == '(')
    read_arguments(text, word);
}

/// Behind spaces and, where brackets are comments, behind those (they nest).
void skip_comments(BlockText& text) {
  const std::string_view line = text.line;
  while (text.peek() == '(' && text.dialect.lexis.bracket == Bracket::comment) {
    const std::size_t open = text.pos;
    int depth = 0;
    do {
      if (text.pos == line.size()) fail(Fault::bracket_unclosed, column(open));
      depth += line[text.pos] == '(' ? 1 : line[text.pos] == ')' ? -1 : 0;
      ++text.pos;
    } while (depth > 0);
  }
}

/// A number as programs write it; with a comma for its point where the language has that.
Decimal decimal_at(const Lexis& lexis, std::string_view line, std::size_t pos) {
  Decimal number = read_decimal(line, pos);
  const std::size_t comma = pos + number.length;
  if (!lexis.decimal_comma || number.fraction || comma + 1 >= line.size() || line[comma] != ',' ||
      !is_digit(line[comma + 1]))
    return number;
  std::size_t end = comma + 1;
  while (end < line.size() && is_digit(line[end])) ++end;
  std::string written(line.substr(pos, end - pos));
  written[comma - pos] = '.';
  return read_decimal(written, 0);
}

}  // namespace

void read_words(const Dialect& dialect, const AxisLetters& axes, Block& block) {
  Met met;
  BlockText text{dialect, axes, block, block.line.substr(0, block.end), block.body};
  for (skip_comments(text); text.pos < block.end; skip_comments(text)) {
    if (dialect.lexis.skip_anywhere && text.line[text.pos] == dialect.lexis.skip) {
      const std::uint8_t level = read_skip_level(dialect.lexis, text.line, text.pos);
      if ((block.levels_left_out >> level & 1u) == 0) continue;
      block.end = block.count == 0 ? block.body : block.words[block.count - 1u].end;
      break;
    }
    if (block.count == Block::kMaxWords)
      fail(Fault::too_many_words, text.column(), {std::to_string(Block::kMaxWords)});
    Word& word = block.words[block.count];
    read_word(text, word);
    word.end = static_cast<std::uint16_t>(text.pos);
    ++block.count;
    check_word(dialect, block, word, met);
  }
  if (block.g_count > 1) check_conflicts(dialect, block);
  if (met.later_g) name_later_g(block);
}

void BlockText::expect(char c) {
  if (peek() != c) fail(Fault::expected, column(), {std::string(1, c)});
  ++pos;
}

void BlockText::bracketed(Value& value) {
  const std::size_t open = pos;
  value.expression = static_cast<std::uint16_t>(open + 1);
  int depth = 0;
  do {
    if (pos == line.size()) fail(Fault::bracket_unclosed, program::column(open));
    depth += line[pos] == '(' ? 1 : line[pos] == ')' ? -1 : 0;
    ++pos;
  } while (depth > 0);
}

void BlockText::expression(Value& value) {
  pos = skip_spaces(line, pos);
  value.column = static_cast<std::uint16_t>(column());
  value.expression = static_cast<std::uint16_t>(pos + 1);
  evaluate(dialect.expressions, line, pos, nullptr);
}

void check_parameter(const Dialect& dialect, ParameterKind kind, std::string_view word, const Value& value) {
  const ParameterSet& set = dialect.parameters;
  if (kind == ParameterKind::any) return;
  if (kind == ParameterKind::none) fail(Fault::g_with_parameter, value.column);
  const bool whole = kind == ParameterKind::whole;
  if (whole == (value.parameter < set.first_real)) return;
  fail(Fault::parameter_type, value.column,
       {std::string(word), std::string(whole ? set.whole_numbers : set.real_numbers),
        set.name_of(value.parameter)});
}

Value read_value(BlockText& text, std::string_view word) {
  const std::string_view line = text.line;
  Value value;
  std::size_t at = skip_spaces(line, text.pos);
  const bool sign = at < line.size() && (line[at] == '-' || line[at] == '+');
  value.column = static_cast<std::uint16_t>(column(at));
  if (sign) {
    value.negative = line[at] == '-';
    at = skip_spaces(line, at + 1);
  }
  const Decimal number = decimal_at(text.dialect.lexis, line, at);
  if (number.length != 0) {
    value.number = value.negative ? -number.value : number.value;
    value.fraction = number.fraction;
    text.pos = at + number.length;
    return value;
  }
  const std::size_t behind_name = text.pos;
  text.pos = at;
  if (at < line.size() && text.dialect.value != nullptr && text.dialect.value(text, value)) return value;
  text.pos = behind_name;
  if (sign)
    fail(Fault::expected, column(at),
         {text::both("number after " + std::string(word), "число после " + std::string(word))});
  value.bare = true;
  return value;
}

}  // namespace servogate::program
