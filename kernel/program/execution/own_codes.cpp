// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/own_codes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

/// A dialect whose tables are its own.
struct Extended {
  Dialect dialect;
  std::vector<GRule> g;
  std::vector<MRule> m;
};

/// Number of "G50" or "M77"; -1: it is none.
int number_of(const std::string& code) {
  std::size_t pos = 1;
  const bool letter = code.size() > 1 && (code[0] == 'G' || code[0] == 'M');
  const int number = letter ? read_index(code, pos) : -1;
  return letter && pos == code.size() ? number : -1;
}

bool has_word(const Dialect& language, char letter, int number) {
  const auto is_g = [number](const GRule& rule) { return rule.number == number; };
  const auto is_m = [number](const MRule& rule) { return rule.code == number; };
  return letter == 'G' ? std::any_of(language.g.begin(), language.g.end(), is_g)
                       : std::any_of(language.m.begin(), language.m.end(), is_m);
}

bool gives_parameter(Meaning meaning) {
  switch (meaning) {
    case Meaning::axis:
    case Meaning::centre_1:
    case Meaning::centre_2:
    case Meaning::centre_of:
    case Meaning::pitch:
    case Meaning::radius:
    case Meaning::feed:
    case Meaning::count:
    case Meaning::angle:
    case Meaning::amount:
      return true;
    default:
      return false;
  }
}

const MachineModel::OwnCode& row_of(const MachineModel& machine, char letter, int number) {
  return *std::find_if(machine.own_codes.begin(), machine.own_codes.end(), [&](const auto& row) {
    return row.code[0] == letter && number_of(row.code) == number;
  });
}

}  // namespace

std::shared_ptr<const Dialect> with_own_codes(const Dialect& language, const MachineModel& machine) {
  if (machine.own_codes.empty()) return nullptr;
  const auto extended = std::make_shared<Extended>();
  extended->dialect = language;
  extended->g.assign(language.g.begin(), language.g.end());
  extended->m.assign(language.m.begin(), language.m.end());
  for (const MachineModel::OwnCode& row : machine.own_codes) {
    const int number = number_of(row.code);
    if (number < 0 || has_word(language, row.code[0], number)) continue;  // told by check_own_code()
    if (row.code[0] == 'G')
      extended->g.push_back({.number = static_cast<std::uint16_t>(number),
                             .group = '!',
                             .function = Function::own,
                             .motion = run_own_code});
    else
      extended->m.push_back({static_cast<std::uint16_t>(number), false, MAction::own});
  }
  extended->dialect.g = extended->g;
  extended->dialect.m = extended->m;
  return {extended, &extended->dialect};
}

void check_own_code(const Dialect& language, const Parameters& parameters, const MachineModel::OwnCode& row) {
  const int number = number_of(row.code);
  const char letter = row.code.empty() ? 'G' : row.code[0];
  const double most = language.letters[static_cast<std::size_t>(letter == 'M' ? 'M' : 'G')].max;
  if (number < 0 || number > most) fail(Fault::own_code_bad, 0, {row.code, text::number(most)});
  if (has_word(language, letter, number)) fail(Fault::own_code_taken, 0, {row.code});
  for (const auto& [word, parameter] : row.words) {
    const auto c = word.size() == 1 ? static_cast<unsigned char>(word[0]) : 0u;
    if (c >= language.letters.size() || !gives_parameter(language.letters[c].meaning))
      fail(Fault::own_code_word, 0, {row.code, word});
    if (parameter != std::floor(parameter) || !(std::abs(parameter) < 1e6))
      fail(Fault::own_code_word, 0, {row.code, word + " = " + text::number(parameter)});
    Parameters probe = parameters;
    probe.set(static_cast<int>(parameter), 0.0, 0);  // throws where there is none
  }
}

void Execution::gather_own(BlockWords& words, const Word& word) {
  if (words.instead != nullptr && dialect_.arrange == nullptr)
    fail(Fault::word_without_function, word.column, {word_text(dialect_, block_, word)});
  words.instead = run_own_code;
  words.instead_word = &word;
}

void run_own_code(Execution& run, const BlockWords& words) {
  const Block& block = run.block();
  const Word& code = *words.instead_word;
  const char letter = code.meaning == Meaning::m ? 'M' : 'G';
  const MachineModel::OwnCode& row =
      row_of(run.machine(), letter, run.numbers().whole(code.value, std::string(1, letter)));
  if (run.contour().engaged()) fail(Fault::contour_excludes, code.column, {row.code});
  std::vector<std::pair<int, const Word*>> values;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (&word == &code || word.meaning == Meaning::number) continue;
    const auto named = row.words.find(std::string(1, word.letter));
    if (named == row.words.end())
      fail(Fault::own_code_alone, word.column, {word_text(run.dialect(), block, word), row.code});
    values.emplace_back(static_cast<int>(named->second), &word);
  }
  for (const auto& [parameter, word] : values)
    run.state().parameters.set(parameter, run.numbers().resolve(word->value), word->column);
  run.motion().end_profile();
  run.flow().call(row.program, 1, code.column);
}

}  // namespace servogate::program
