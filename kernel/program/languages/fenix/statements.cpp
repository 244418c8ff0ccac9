// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/faults.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

namespace servogate::program::fenix {
namespace {

constexpr double kMostRepeats = 1e6;
constexpr double kMostSeconds = 2'147'483.0;

/// The number of an L, an @ or an R, kept in the word's text; at most `most`.
void read_number_of(BlockText& text, Word& word, std::string_view name, int least, int most) {
  const std::size_t start = text.pos;
  const int number = read_index(text.line, text.pos);
  if (number < least || number > most)
    fail(Fault::out_of_range, word.column,
         {std::string(name), std::string(text.line.substr(start, text.pos - start)), std::to_string(least),
          std::to_string(most)});
  word.text_begin = static_cast<std::uint16_t>(number);
}

// --- R7(expression), $name(expression)

void read_r(BlockText& text, Word& word) {
  read_number_of(text, word, "R", 1, kLastR);
  if (text.peek() != '(') fail(Fault::expected, text.column(), {"("});
  text.bracketed(word.value);
}

void read_variable(BlockText& text, Word& word) {
  const char c = text.pos < text.line.size() ? text.line[text.pos] : '\0';
  if (!is_letter(c)) fail(Fault::unknown_word, word.column, {"$" + std::string(c == '\0' ? 0 : 1, c), {}});
  word.text_begin = static_cast<std::uint16_t>(kFirstLetter + capital(c) - 'A');
  while (text.pos < text.line.size() && (is_letter(text.line[text.pos]) || is_digit(text.line[text.pos])))
    ++text.pos;
  if (text.peek() != '(') fail(Fault::expected, text.column(), {"("});
  text.bracketed(word.value);
}

void assign(Execution& run, const Word& word) {
  run.state().parameters.set(word.text_begin, word.value.number, word.column);
}

// --- ~(condition) N6

void read_jump(BlockText& text, Word& word) {
  if (text.peek() != '(') fail(Fault::expected, text.column(), {"("});
  text.bracketed(word.value);
  const char c = text.peek();
  if (c != 'N' && c != ':') fail(Fault::expected, text.column(), {"N"});
  word.text_begin = static_cast<std::uint16_t>(text.pos++);
  if (read_index(text.line, text.pos) < 0) fail(Fault::number_missing_block, text.column());
  word.text_end = static_cast<std::uint16_t>(text.pos);
}

/// The block of a number among the lines from `first` to `behind`.
std::uint32_t target(const Source& source, std::string_view name, std::uint32_t first, std::uint32_t behind,
                     int column) {
  std::size_t at = 1;
  const int number = read_index(name, at);
  const std::uint32_t line = first < behind ? source.find_number(number, first, behind - 1) : Source::kNone;
  if (line == Source::kNone) fail(Fault::label_missing, column, {std::string(name)});
  return line;
}

struct Lines {
  std::uint32_t first, behind;
};

/// Where the jumps of a line lead: inside of its cycle, or of all that is no cycle.
Lines region(const Source& source, std::uint32_t line) {
  const auto [begin, number] = source.definition_at(line);
  if (begin != Source::kNone && number >= kFirstCycle) return {begin + 1, source.behind_definition(begin)};
  return {source.start() == Source::kNone ? 0 : source.start(), source.lines()};
}

void jump(Execution& run, const Word& word) {
  if (word.value.number == 0.0) return;
  const Lines lines = region(run.flow().source(), run.flow().line());
  run.flow().jump(
      target(run.flow().source(), run.block().text(word), lines.first, lines.behind, word.column));
}

// --- L7: a subprogram begins (no block number) or is called; what stands behind a call is not read

bool is_definition(const Block& block) { return block.number_column == 0; }

void read_call(BlockText& text, Word& word) {
  read_number_of(text, word, "L", 0, 99);
  if (!is_definition(text.block)) text.pos = text.line.size();
}

void call(Execution& run, const Word& word) {
  if (is_definition(run.block())) return;
  const std::uint32_t line = run.flow().source().definition(word.text_begin);
  if (line == Source::kNone)
    fail(Fault::program_missing, word.column, {"L" + std::to_string(word.text_begin)});
  run.flow().call(line + 1, 1, word.column);
}

// --- H5: what follows up to M20, so often

void read_repeat(BlockText& text, Word& word) {
  word.value = read_value(text, "H");
  if (word.value.bare) fail(Fault::value_missing, word.column, {"H", "H"});
}

void repeat(Execution& run, const Word& word) {
  const double count = std::trunc(run.numbers().resolve(word.value));
  if (count > kMostRepeats)
    fail(Fault::out_of_range, word.column, {"H", text::number(count), "0", text::number(kMostRepeats)});
  run.flow().repeat(count > 0.0 ? static_cast<int>(count) : 0, word.column);
}

// --- @900 ... #

void read_header(BlockText& text, Word& word) { read_number_of(text, word, "@", 0, 999); }

void end_cycle(Execution& run, const Word& word) {
  if (!run.flow().leave_subprogram())
    fail(Fault::end_without_repeat, word.column, {std::string(word.rule->name), "@"});
}

}  // namespace

const WordRule kAssignR = {.name = "R", .read = read_r, .run = assign};
const WordRule kAssignVariable = {.name = "$", .read = read_variable, .run = assign};
const WordRule kJump = {.name = "~", .when = When::at_the_end, .read = read_jump, .run = jump};
const WordRule kCall = {.name = "L", .when = When::at_the_end, .read = read_call, .run = call};
const WordRule kRepeat = {.name = "H", .when = When::at_the_end, .read = read_repeat, .run = repeat};
const WordRule kCycleHeader = {.name = "@", .when = When::at_the_end, .read = read_header, .run = end_cycle};
const WordRule kCycleEnd = {
    .name = "#", .when = When::at_the_end, .read = [](BlockText&, Word&) {}, .run = end_cycle};

/// X(2+7), XR1, X$24
bool value_in_place_of_number(BlockText& text, Value& value) {
  const char c = text.line[text.pos];
  if (c == '(') {
    text.bracketed(value);
    return true;
  }
  const bool parameter = c == 'R' && text.pos + 1 < text.line.size() && is_digit(text.line[text.pos + 1]);
  if (!parameter && c != '$') return false;
  value.expression = static_cast<std::uint16_t>(text.pos + 1);
  double ignored = 0.0;
  return text.dialect.expressions.variable(text.line, text.pos, nullptr, ignored);
}

LineMark mark(std::string_view line, std::size_t pos) {
  using Kind = LineMark::Kind;
  if (line[pos] == 'L' || line[pos] == '@') {
    std::size_t at = pos + 1;
    const int number = read_index(line, at);
    if (number < 0) return {};
    return {Kind::definition, line[pos] == 'L' ? number : kFirstCycle + number};
  }
  const auto bit = [](char c) { return std::uint64_t{1} << (static_cast<unsigned char>(c) & 63u); };
  const std::uint64_t marks = bit(';') | bit('/') | bit('(') | bit(')') | bit('$') | bit('H') | bit('M');
  int depth = 0;
  for (std::size_t i = pos; i < line.size(); ++i) {
    const char c = line[i];
    if ((marks & bit(c)) == 0) continue;  // most characters, in one step
    if (c == ';' || (c == '/' && i + 1 < line.size() && line[i + 1] == '/')) break;
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == '$')
      while (i + 1 < line.size() && (is_letter(line[i + 1]) || is_digit(line[i + 1]))) ++i;
    if (depth != 0) continue;
    if (c == 'H') return {Kind::repeat};
    std::size_t at = i + 1;
    if (c == 'M' && read_index(line, at) == 20) return {Kind::end_of_repeat};
  }
  return {};
}

/// M17 stands in a line, in front of its comment.
bool returns(std::string_view line) {
  for (std::size_t i = 0; i < line.size() && line[i] != ';' && line.substr(i, 2) != "//"; ++i) {
    std::size_t at = i + 1;
    if (line[i] == 'M' && read_index(line, at) == 17) return true;
  }
  return false;
}

/// A subprogram in front of the main program ends there; otherwise a call would run on into the main program.
void judge_end(const Judgement& reading, const Word& word) {
  const Source& source = reading.source;
  if (source.start() == Source::kNone || reading.line >= source.start()) return;
  for (std::uint32_t line = reading.line + 1; line < source.start(); ++line) {
    if (returns(source.line(line))) return;
    const LineMark next = source.line(line).empty() ? LineMark{} : mark(source.line(line), 0);
    if (next.kind == LineMark::Kind::definition)
      fail(Wrong::subprogram_open, word.column, {std::to_string(word.text_begin), "L"});
  }
  fail(Wrong::subprogram_open, word.column, {std::to_string(word.text_begin), "%"});
}

void judge(const Judgement& reading, const Block& block) {
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.rule == &kCall && !is_definition(block) &&
        reading.source.definition(word.text_begin) == Source::kNone)
      fail(Fault::program_missing, word.column, {"L" + std::to_string(word.text_begin)});
    if (word.rule == &kCall && is_definition(block)) judge_end(reading, word);
    if (word.rule == &kJump) {
      const Lines lines = region(reading.source, reading.line);
      target(reading.source, block.text(word), lines.first, lines.behind, word.column);
    }
    if (word.rule == &kRepeat && reading.source.repeat_partner(reading.line) == Source::kNone)
      fail(Fault::repeat_without_end, word.column, {"H", "M20"});
    if (word.meaning == Meaning::m && word.value.number == 20.0 &&
        reading.source.repeat_partner(reading.line) == Source::kNone)
      fail(Fault::end_without_repeat, word.column, {"M20", "H"});
  }
}

/// Of this file, of the program, or of the file of the user's cycles that lies beside it.
void call_cycle(Execution& run, const BlockWords& words) {
  const Word& word = *words.instead_word;
  const int number = static_cast<int>(word.value.number);
  int file = run.flow().file();
  std::uint32_t line = run.flow().source().definition(kFirstCycle + number);
  if (line == Source::kNone && file != 0) {
    file = 0;
    line = run.flow().main_source().definition(kFirstCycle + number);
  }
  if (line == Source::kNone && (file = run.flow().open(kCycleFile)) >= 0)
    line = run.flow().source(file).definition(kFirstCycle + number);
  if (line == Source::kNone) fail(Fault::g_unknown, word.column, {std::to_string(number)});
  run.refuse_all_but(words, {});
  std::vector<double> arguments;
  for (std::size_t i = 0; i < word.argument_count; ++i) arguments.push_back(run.block().arguments[i].number);
  run.motion().end_profile();
  run.flow().call(line + 1, 1, word.column, std::move(arguments), file);
}

/// Milliseconds as an argument, or of any axis' word or E, which then moves nothing; 3 s without.
void dwell(Execution& run, const BlockWords& words) {
  const Block& block = run.block();
  double ms = 3000.0;
  int column = words.instead_word->column;
  const Word* word = words.amount;
  for (const Word* axis : words.axis) {
    if (axis == nullptr) continue;
    if (word != nullptr) run.refuse_all_but(words, {word, words.feed});  // of two times one counts
    word = axis;
  }
  run.refuse_all_but(words, {word, words.feed});
  run.motion().store_feed(words);
  if (words.instead_word->argument_count > 0 && !block.arguments[0].bare) {
    ms = block.arguments[0].number;
  } else if (word != nullptr) {
    ms = run.numbers().resolve(word->value);
    column = word->column;
  }
  if (!(ms >= 0.0 && ms / 1000.0 <= kMostSeconds))
    fail(Fault::out_of_range, column, {"G4 ", text::number(ms), "0", text::number(kMostSeconds * 1000.0)});
  run.motion().dwell(ms / 1000.0);
}

}  // namespace servogate::program::fenix
