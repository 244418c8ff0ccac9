// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/own_codes.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// Subprograms and macros (specification 13, 16, 22).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kSplit = 10'000;  ///< of P of M98: passes above, the number below
constexpr int kMostPasses = 9999;
constexpr double kByWord = 1.0, kModal = 2.0;  ///< marks of a call, in its arguments

bool eight_digits(const Execution& run) { return bit(run, 6); }

std::string padded(int number) {
  std::string digits = std::to_string(number);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

bool exists(const Execution& run, const std::string& name) {
  const auto& names = run.flow().names();
  if (std::find(names.begin() + 1, names.end(), name) != names.end()) return true;
  return run.flow().loader() && run.flow().loader()(name).has_value();
}

/// 0033, and 33 where there is no such program.
std::string name_of(const Execution& run, int number) {
  const std::string name = eight_digits(run) ? std::to_string(number) : padded(number);
  const std::string other = std::to_string(number);
  return exists(run, name) || !exists(run, other) ? name : other;
}

struct Called {
  int number = 0, passes = 1;
};

int passes_of(const Execution& run, int otherwise) {
  const int passes = whole(run, 'L', otherwise);
  if (passes < 1 || passes > kMostPasses)
    fail(Fault::out_of_range, find(run.block(), 'L')->column,
         {"L", std::to_string(passes), "1", std::to_string(kMostPasses)});
  return passes;
}

/// M98 P30045 is three passes of 0045; with L, or with numbers of eight digits, P is the number alone.
Called subprogram_of(const Execution& run, int column) {
  const Word* p = find(run.block(), 'P');
  if (p == nullptr) fail(Wrong::letter_missing, column, {"M98", "P"});
  const int number = whole(run, 'P', 0);
  const bool split = !eight_digits(run) && find(run.block(), 'L') == nullptr;
  if (!split) return {number, passes_of(run, 1)};
  return {number % kSplit, std::max(1, number / kSplit)};
}

Called macro_of(const Execution& run, const BlockWords& words) {
  const Word* p = find(run.block(), 'P');
  if (p == nullptr) fail(Wrong::letter_missing, column(words), {g_word(run, words), "P"});
  const int number = whole(run, 'P', 0), digits = eight_digits(run) ? 8 : 4;
  if (static_cast<int>(std::to_string(number).size()) > digits)
    fail(Wrong::program_digits, p->column, {std::to_string(number), std::to_string(digits)});
  return {number, passes_of(run, 1)};
}

void call(Execution& run, const std::string& name, int passes, int column, double mark = 0.0) {
  run.motion().end_profile();
  run.flow().call(name, passes, column);
  if (mark != 0.0) run.state().flow.calls.back().arguments = {mark};
}

void call_subprogram(Execution& run, const Word& word) {
  const Called called = subprogram_of(run, word.column);
  call(run, name_of(run, called.number), called.passes, word.column);
}

std::uint32_t line_of(const Source& source, int number, std::uint32_t from) {
  std::uint32_t line = Source::kNone;
  if (from < source.lines()) line = source.find_number(number, from, source.lines() - 1);
  if (line == Source::kNone && from > 0) line = source.find_number(number, from - 1, 0);
  return line;
}

/// M99 in the main program goes to its beginning; with P to that block.
void go_back(Execution& run, const Word& word) {
  FlowState& flow = run.state().flow;
  const Word* p = find(run.block(), 'P');
  const bool main = flow.calls.empty();
  if (!main) {
    if (p != nullptr) flow.calls.back().left = 1;
    run.flow().leave_subprogram();
    if (p == nullptr) return;
  }
  std::uint32_t line = 0;
  if (p != nullptr) {
    const int number = whole(run, 'P', 0);
    line = line_of(run.flow().source(), number, main ? 0 : flow.line);
    if (line == Source::kNone) fail(Fault::label_missing, word.column, {"N" + std::to_string(number)});
  }
  run.motion().end_profile();
  run.flow().jump(line);
}

void call_modal(Execution& run, const Word& word) {
  const State& state = run.state();
  call(run, name_of(run, static_cast<int>(value(state, own::macro)) - 1),
       static_cast<int>(value(state, own::macro_passes)), word.column, kModal);
}

constexpr WordRule kSubprogram = {.name = "M98", .when = When::at_the_end, .run = call_subprogram};
constexpr WordRule kBack = {.name = "M99", .when = When::at_the_end, .run = go_back};
constexpr WordRule kModalMacro = {.name = "G66", .when = When::at_the_end, .run = call_modal};

void at_the_end(BlockWords& words, Word& word, const WordRule& rule) {
  if (words.statement_count > 0)
    fail(Wrong::macro_twice, word.column,
         {std::string(words.statements[0]->rule->name), std::string(rule.name)});
  word.rule = &rule;
  words.statements[static_cast<std::size_t>(words.statement_count++)] = &word;
}

void call_by_word(Execution& run, const BlockWords& words) {
  const Word& word = *words.instead_word;
  const char letter = word.meaning == Meaning::m ? 'M' : 'G';
  const std::string code = letter + g_name(run.numbers().whole(word.value, std::string(1, letter)));
  const auto& codes = run.machine().own_codes;
  const auto row = std::find_if(codes.begin(), codes.end(), [&](const auto& c) { return c.code == code; });
  if (run.contour().engaged()) fail(Fault::contour_excludes, word.column, {code});
  call(run, row->program, passes_of(run, 1), word.column, kByWord);
}

/// The words of the block, and in which order I, J and K stand (specification 16.2).
void take_arguments(Execution& run, const BlockWords& words) {
  State& state = run.state();
  std::fill(state.own.begin() + own::argument, state.own.begin() + own::argument_g, 0.0);
  const Block& block = run.block();
  int set = 1, last = -1;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    const std::string_view none = "GLNOP";
    if (&word == words.instead_word || !is_capital(word.letter) ||
        none.find(word.letter) != std::string_view::npos)
      continue;
    const double number = run.numbers().resolve(word.value);
    const std::size_t letter = static_cast<std::size_t>(word.letter - 'A');
    state.own[own::argument_set + letter] = 1.0;
    if (word.letter < 'I' || word.letter > 'K') {
      state.own[own::argument + letter] = number;
      state.own[own::argument_real + letter] = word.value.fraction || word.value.expression != 0 ? 1.0 : 0.0;
      continue;
    }
    const int which = word.letter - 'I';
    if (which <= last) ++set;
    last = which;
    double& count = state.own[own::argument_count + at(which)];
    if (count == 10.0) fail(Wrong::macro_argument, word.column, {g_word(run, words), "10", "I, J, K"});
    const std::size_t place = at(which) * 10 + static_cast<std::size_t>(count);
    state.own[own::argument_ijk + place] = number;
    state.own[own::argument_order + place] = set;
    count += 1.0;
  }
}

}  // namespace

bool is_macro_program(const Execution& run, double kind) {
  const auto& calls = run.state().flow.calls;
  return std::any_of(calls.begin(), calls.end(),
                     [kind](const auto& c) { return !c.arguments.empty() && c.arguments[0] == kind; });
}

bool take_macro(Execution& run, BlockWords& words) {
  const bool by_word = words.instead == run_own_code;
  if (words.instead != call_macro && words.instead != modal_macro && !by_word) return false;
  if (by_word) {
    const Word& word = *words.instead_word;
    const Block& block = run.block();
    for (std::size_t i = 0; i < block.count; ++i) {
      const Word& other = block.words[i];
      const MRule* rule = other.meaning == Meaning::m && &other != &word
                              ? run.dialect().find_m(static_cast<int>(other.value.number))
                              : nullptr;
      if (rule != nullptr && (rule->action == MAction::own || rule->code == 98))
        fail(Wrong::macro_twice, other.column,
             {word_text(run.dialect(), block, word), word_text(run.dialect(), block, other)});
    }
    if (is_macro_program(run, kByWord)) {
      if (word.meaning == Meaning::g) fail(Fault::g_unknown, word.column, {g_name(word.g->number)});
      words.m[static_cast<std::size_t>(words.m_count)] = &word;
      words.m_code[static_cast<std::size_t>(words.m_count++)] = static_cast<int>(word.value.number);
      words.instead = nullptr;
      words.instead_word = nullptr;
      return false;
    }
    words.instead = call_by_word;
  }
  take_arguments(run, words);
  value(run.state(), own::argument_g) =
      by_word && words.instead_word->meaning == Meaning::g ? words.instead_word->value.number : 0.0;
  leave_to_instead(words);
  return true;
}

void call_macro(Execution& run, const BlockWords& words) {
  const Called called = macro_of(run, words);
  call(run, name_of(run, called.number), called.passes, column(words), 3.0);
}

void modal_macro(Execution& run, const BlockWords& words) {
  const Called called = macro_of(run, words);
  const std::string name = name_of(run, called.number);
  if (!exists(run, name)) fail(Fault::program_missing, column(words), {name});
  value(run.state(), own::macro) = called.number + 1.0;
  value(run.state(), own::macro_passes) = called.passes;
}

void macro_off(Execution& run, BlockWords&, const Word&) { value(run.state(), own::macro) = 0.0; }

void arrange_calls(Execution& run, BlockWords& words) {
  Block& block = run.block();
  int kept = 0;
  for (int i = 0; i < words.m_count; ++i) {
    const int code = words.m_code[at(i)];
    const auto place = static_cast<std::size_t>(words.m[at(i)] - block.words.data());
    if (code == 98 || code == 99) {
      if (words.instead != nullptr && words.instead_word != nullptr)
        fail(Wrong::macro_twice, words.m[at(i)]->column, {g_word(run, words), "M" + std::to_string(code)});
      at_the_end(words, block.words[place], code == 98 ? kSubprogram : kBack);
      continue;
    }
    words.m[at(kept)] = words.m[at(i)];
    words.m_code[at(kept++)] = code;
  }
  words.m_count = kept;
  const bool modal = value(run.state(), own::macro) != 0.0 && words.axes > 0 && words.instead == nullptr;
  if (!modal || words.statement_count > 0 || is_macro_program(run, kModal)) return;
  for (std::size_t i = 0; i < block.count; ++i)
    if (block.words[i].meaning == Meaning::axis) return at_the_end(words, block.words[i], kModalMacro);
}

void fast_call(Execution& run, const BlockWords& words) {
  only(run, "PL");
  const int number = whole(run, 'P', 0);
  if (number <= 1) return;
  call(run, name_of(run, number), passes_of(run, 1), column(words));
}

void judge(const Judgement& reading, const Block& block) {
  const Word* p = find(block, 'P');
  if (p == nullptr || p->value.expression != 0) return;
  const int number = static_cast<int>(p->value.number);
  const bool eight = eight_digits(reading.run);
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    const bool sub = word.meaning == Meaning::m && word.value.number == 98.0;
    const bool macro = word.g != nullptr && (word.g->motion == call_macro || word.g->motion == modal_macro);
    if (!sub && !macro) continue;
    const bool split = sub && !eight && find(block, 'L') == nullptr;
    const int named = split ? number % kSplit : number;
    reading.calls(reading.where, eight ? std::to_string(named) : padded(named));
  }
}

namespace {

/// The block is read again behind each copy, until all of them are done.
void copy(Execution& run, const BlockWords& words, const Called& called, double angle, Position shift,
          std::array<double, 2> centre) {
  State& state = run.state();
  double& done = value(state, own::copies);
  const bool over = done >= called.passes;
  value(state, own::copy_angle) = over ? 0.0 : angle * done;
  for (std::size_t i = 0; i < 2; ++i) state.own[own::copy_at + i] = over ? 0.0 : centre[i];
  for (std::size_t a = 0; a < own::kAxes; ++a) state.own[own::copy_shift + a] = over ? 0.0 : shift[a] * done;
  refresh_offsets(run);
  run.motion().end_profile();
  done = over ? 0.0 : done + 1.0;
  if (over) return;
  const std::uint32_t again = run.flow().line();
  call(run, name_of(run, called.number), 1, column(words));
  state.flow.calls.back().back = again;
}

}  // namespace

/// G72.1: about X and Y, each copy further by R. The first one stands where the subprogram says.
void copy_turned(Execution& run, const BlockWords& words) {
  only(run, "XYZPLR");
  run.frames().need_plane(column(words));
  const FramesState& frames = run.state().frames;
  std::array<double, 2> centre{};
  const int axes[] = {frames.axis1, frames.axis2};
  for (std::size_t i = 0; i < 2; ++i)
    if (const Word* word = words.axis[at(axes[i])]; word != nullptr)
      centre[i] = run.numbers().length(axes[i], word->value);
  copy(run, words, macro_of(run, words), number(run, 'R'), {}, centre);
}

/// G72.2: each copy further by I, J and K.
void copy_shifted(Execution& run, const BlockWords& words) {
  only(run, "IJKPL");
  Position shift{};
  for (const char letter : {'I', 'J', 'K'}) {
    const Word* word = find(run.block(), letter);
    if (word != nullptr && word->axis >= 0) shift[at(word->axis)] = length(run, *word);
  }
  copy(run, words, macro_of(run, words), 0.0, shift, {});
}

}  // namespace servogate::program::sinumerik::iso
