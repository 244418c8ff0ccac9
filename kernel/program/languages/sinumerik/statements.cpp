// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program::sinumerik {
namespace {

constexpr double kMostPasses = 9999;
constexpr double kMostSeconds = 999'999.999;

bool name_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

std::string_view name_at(std::string_view line, std::size_t& pos) {
  const std::size_t start = pos;
  while (pos < line.size() && name_character(line[pos])) ++pos;
  return line.substr(start, pos - start);
}

// --- R7 = expression

void read_r(BlockText& text, Word& word) {
  const std::size_t start = text.pos;
  const int index = read_index(text.line, text.pos);
  if (index < 0) fail(Fault::parameter_number_missing, text.column(), {"R"});
  if (index >= kRParameters)
    fail(Fault::parameter_absent, word.column,
         {"R" + std::string(text.line.substr(start, text.pos - start)),
          "R" + std::to_string(kRParameters - 1)});
  word.text_begin = static_cast<std::uint16_t>(index);
  text.expect('=');
  text.expression(word.value);
}

void assign(Execution& run, const Word& word) {
  run.state().parameters.set(word.text_begin, word.value.number, word.column);
}

void read_system_variable(BlockText& text, Word& word) {
  name_at(text.line, text.pos);
  const std::size_t start = word.column - 1u;
  fail(iso::Wrong::system_variable, word.column, {std::string(text.line.substr(start, text.pos - start))});
}

// --- GOTOF LABEL, IF condition GOTOB N100

enum class Way : std::uint8_t { forward, backward, both };

/// Keyword and target as they stand in the word's text.
struct Jump {
  Way way;
  std::string_view target;
};

Jump jump_of(std::string_view text, int column) {
  std::size_t pos = 0;
  const std::string keyword = in_capitals(name_at(text, pos));
  const Way way = keyword == "GOTOF"   ? Way::forward
                  : keyword == "GOTOB" ? Way::backward
                  : keyword == "GOTO"  ? Way::both
                                      : throw ProgramError{&entry(Fault::expected), column, {"GOTOF, GOTOB"}};
  pos = skip_spaces(text, pos);
  return {way, text.substr(pos)};
}

void take_jump(BlockText& text, Word& word, std::size_t begin) {
  text.pos = begin;
  jump_of(name_at(text.line, text.pos), static_cast<int>(begin) + 1);
  text.peek();
  const std::size_t target = text.pos;
  if (name_at(text.line, text.pos).empty())
    fail(Fault::expected, static_cast<int>(target) + 1,
         {text::both("label or block number", "метка или номер кадра")});
  word.text_begin = static_cast<std::uint16_t>(begin);
  word.text_end = static_cast<std::uint16_t>(text.pos);
}

void read_goto(BlockText& text, Word& word) { take_jump(text, word, word.column - 1u); }

void read_if(BlockText& text, Word& word) {
  text.expression(word.value);
  text.peek();
  take_jump(text, word, text.pos);
}

std::uint32_t find_target(const Source& source, std::uint32_t line, const Jump& jump, int column) {
  std::size_t digits = 1;
  const bool number = !jump.target.empty() && capital(jump.target[0]) == 'N' && jump.target.size() > 1 &&
                      is_digit(jump.target[1]);
  const int wanted = number ? read_index(jump.target, digits) : -1;
  const auto search = [&](std::uint32_t first, std::uint32_t last) {
    return number ? source.find_number(wanted, first, last) : source.find_label(jump.target, first, last);
  };
  std::uint32_t found = Source::kNone;
  if (jump.way != Way::backward && line + 1 < source.lines()) found = search(line + 1, source.lines() - 1);
  if (found == Source::kNone && jump.way != Way::forward) found = search(line, 0);
  if (found == Source::kNone) fail(Fault::label_missing, column, {std::string(jump.target)});
  return found;
}

void jump(Execution& run, const Word& word) {
  const Jump asked = jump_of(run.block().text(word), word.column);
  run.flow().jump(find_target(run.flow().source(), run.flow().line(), asked, word.column));
}

void jump_if(Execution& run, const Word& word) {
  if (word.value.number != 0.0) jump(run, word);
}

// --- L10 P3, NAME P3, RET

void read_number_of_program(BlockText& text, Word& word) {
  word.text_begin = static_cast<std::uint16_t>(word.column - 1u);
  const std::size_t digits = text.pos;
  name_at(text.line, text.pos);
  if (text.pos == digits) fail(Fault::value_missing, word.column, {"L", "L"});
  word.text_end = static_cast<std::uint16_t>(text.pos);
}

void read_name_of_program(BlockText& text, Word&) {
  if (text.peek() == '(') fail(Fault::not_executed, text.column(), {"("});
}

void call(Execution& run, const BlockWords& words) {
  const Word& word = *words.instead_word;
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i)
    if (&block.words[i] != &word && &block.words[i] != words.count && block.words[i].meaning != Meaning::m &&
        block.words[i].meaning != Meaning::g && block.words[i].meaning != Meaning::statement)
      fail(iso::Wrong::beside_call, block.words[i].column, {word_text(run.dialect(), block, block.words[i])});
  const double passes = words.count == nullptr ? 1.0 : run.numbers().resolve(words.count->value);
  if (!(passes >= 1.0 && passes <= kMostPasses))
    fail(Fault::out_of_range, words.count->column,
         {"P", text::number(passes), "1", text::number(kMostPasses)});
  run.motion().end_profile();
  run.flow().call(in_capitals(run.block().text(word)), static_cast<int>(passes), word.column);
}

void leave(Execution& run, const Word&) {
  if (!run.flow().leave_subprogram()) run.finish(false);
}

// --- MSG("text"), STOPRE, DIAMON, DIAMOF

void read_message(BlockText& text, Word& word) {
  text.expect('(');
  word.text_begin = word.text_end = 0;
  if (text.peek() == '"') {
    const std::size_t close = text.line.find('"', text.pos + 1);
    word.text_begin = static_cast<std::uint16_t>(text.pos + 1);
    word.text_end = static_cast<std::uint16_t>(close);
    text.pos = close + 1;
  }
  text.expect(')');
}

void message(Execution& run, const Word& word) { run.emit(Message{std::string(run.block().text(word))}); }

void stop_reading_ahead(Execution& run, const Word&) { run.state().flow.barrier = true; }

void diameter(Execution& run, const Word&) { run.state().modes.across = Function::diameter; }
void diameter_absolute(Execution& run, const Word&) {
  run.state().modes.across = Function::diameter_absolute;
}
void radius(Execution& run, const Word&) { run.state().modes.across = Function::radius; }

void nothing(Execution&, const Word&) {}

/// CDON and CDOF: whether a compensated contour is searched for bottlenecks (specification 10.6).
void watch_on(Execution& run, const Word&) { run.state().motion.watch.on = true; }
void watch_off(Execution& run, const Word&) { run.state().motion.watch.on = false; }

/// SETAL(61000)
void read_alarm(BlockText& text, Word& word) {
  if (text.peek() != '(') fail(Fault::expected, text.column(), {"("});
  text.bracketed(word.value);
}

void raise_alarm(Execution&, const Word& word) {
  fail(iso::Wrong::user_alarm, word.column, {text::number(word.value.number)});
}

/// PROC NAME SAVE DISPLOF: what the caller displays is no matter of the program.
void read_proc(BlockText& text, Word& word) {
  word.text_begin = word.text_end = 0;
  text.peek();
  if (name_at(text.line, text.pos).empty()) fail(Fault::expected, text.column(), {text::both("name", "имя")});
  while (text.peek() != '\0') {
    const std::size_t start = text.pos;
    const std::string name = in_capitals(name_at(text.line, text.pos));
    if (name == "SAVE")
      word.text_end = 1;
    else if (name != "DISPLOF" && name != "SBLOF")
      fail(Fault::expected, static_cast<int>(start) + 1, {"SAVE, DISPLOF"});
  }
}

void begin_proc(Execution& run, const Word& word) {
  if (word.text_end != 0) run.keep_modes();
}

constexpr WordRule kWords[] = {
    {.name = "CR", .meaning = Meaning::radius},
    {.name = "RPL", .meaning = Meaning::angle},
    {.name = "IF", .when = When::at_the_end, .read = read_if, .run = jump_if},
    {.name = "GOTOF", .when = When::at_the_end, .read = read_goto, .run = jump},
    {.name = "GOTOB", .when = When::at_the_end, .read = read_goto, .run = jump},
    {.name = "GOTO", .when = When::at_the_end, .read = read_goto, .run = jump},
    {.name = "RET", .when = When::at_the_end, .run = leave},
    {.name = "TRANS", .when = When::for_motion, .motion = trans},
    {.name = "ATRANS", .when = When::for_motion, .motion = atrans},
    {.name = "ROT", .when = When::for_motion, .motion = rot},
    {.name = "AROT", .when = When::for_motion, .motion = arot},
    {.name = "MSG", .read = read_message, .run = message},
    {.name = "STOPRE", .run = stop_reading_ahead},
    {.name = "DIAMON", .run = diameter},
    {.name = "DIAMOF", .run = radius},
    {.name = "DIAM90", .run = diameter_absolute},
    {.name = "CFC", .run = feed_of_contour},
    {.name = "CFTCP", .run = feed_of_centre},
    {.name = "CFIN", .run = feed_of_inside},
    {.name = "CDON", .run = watch_on},
    {.name = "CDOF", .run = watch_off},
    // Words of the language that this version does not execute.
    {.name = "SCALE"},
    {.name = "ASCALE"},
    {.name = "MIRROR"},
    {.name = "AMIRROR"},
    {.name = "AR"},
    {.name = "TURN"},
    {.name = "CIP"},
    {.name = "CT"},
    {.name = "SPOS"},
    {.name = "LIMS"},
    {.name = "CHF"},
    {.name = "CHR"},
    {.name = "RND"},
    {.name = "RNDM"},
    {.name = "FRC"},
    {.name = "FRCM"},
    {.name = "ANG"},
    {.name = "SF"},
    {.name = "NORM"},
    {.name = "KONT"},
    {.name = "SOFT"},
    {.name = "BRISK"},
    {.name = "FFWON"},
    {.name = "FFWOF"},
    // Runs of short lines are smoothed within the contour tolerance whatever these words say.
    {.name = "COMPON", .run = nothing},
    {.name = "COMPCURV", .run = nothing},
    {.name = "COMPCAD", .run = nothing},
    {.name = "COMPOF", .run = nothing},
    {.name = "SETAL", .read = read_alarm, .run = raise_alarm},
    {.name = "PROC", .read = read_proc, .run = begin_proc},
    {.name = "EXTERN"},
    {.name = "DEF"},
    {.name = "SAVE"},
    {.name = "DISPLOF"},
    {.name = "MCALL"},
    {.name = "CALL"},
    {.name = "ELSE"},
    {.name = "ENDIF"},
    {.name = "WHILE"},
    {.name = "ENDWHILE"},
    {.name = "FOR"},
    {.name = "ENDFOR"},
    {.name = "LOOP"},
    {.name = "ENDLOOP"},
    {.name = "REPEAT"},
    {.name = "REPEATB"},
    {.name = "UNTIL"},
    {.name = "CASE"},
    {.name = "GOTOC"},
    {.name = "GOTOS"},
    {.name = "TRANSMIT"},
    {.name = "TRACYL"},
    {.name = "TRAFOOF"},
    {.name = "MEAS"},
    {.name = "MEAW"},
    {.name = "SETMS"},
    {.name = "SUPA"},
    {.name = "G"},
    // Any other name calls the program that has it.
    {.name = "", .when = When::for_motion, .read = read_name_of_program, .motion = call},
};

}  // namespace

const WordRule kAssignR = {.name = "R", .read = read_r, .run = assign};
const WordRule kCallByNumber = {
    .name = "L", .when = When::for_motion, .read = read_number_of_program, .motion = call};
const WordRule kSystemVariable = {.name = "$", .read = read_system_variable, .run = assign};

std::span<const WordRule> words() { return kWords; }

/// X=10, X=R1*2, X=AC(20), X=IC(R3)
bool value_in_place_of_number(BlockText& text, Value& value) {
  if (text.line[text.pos] != '=' || value.negative) return false;
  ++text.pos;
  text.peek();
  std::size_t pos = text.pos;
  const std::string name = in_capitals(name_at(text.line, pos));
  const bool function = pos < text.line.size() && text.line[pos] == '(';
  if (function && (name == "AC" || name == "IC")) {
    value.dimension = name == "AC" ? Dimension::absolute : Dimension::incremental;
    text.pos = pos;
    text.bracketed(value);
    return true;
  }
  if (function && (name == "DC" || name == "ACP" || name == "ACN" || name == "CAC" || name == "CIC"))
    fail(iso::Wrong::rotary_way, text.column(), {name});
  text.expression(value);
  return true;
}

void judge(const Judgement& reading, const Block& block) {
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.rule == nullptr) continue;
    if (word.rule->run == jump || word.rule->run == jump_if)
      find_target(reading.source, reading.line, jump_of(block.text(word), word.column), word.column);
    if (word.rule->motion == call) reading.calls(reading.where, in_capitals(block.text(word)));
  }
}

void dwell(Execution& run, const BlockWords& words) {
  const Word& g4 = *words.instead_word;
  if (words.speed != nullptr)
    fail(Fault::not_executed, words.speed->column, {word_text(run.dialect(), run.block(), *words.speed)});
  run.refuse_all_but(words, {words.feed});
  if (words.feed == nullptr) fail(Fault::value_missing, g4.column, {"G4", "F"});
  const double seconds = run.numbers().resolve(words.feed->value);
  if (!(seconds >= 0.0 && seconds <= kMostSeconds))
    fail(Fault::out_of_range, words.feed->column,
         {"F", text::number(seconds), "0", text::number(kMostSeconds)});
  run.motion().dwell(seconds);
}

}  // namespace servogate::program::sinumerik
