// SPDX-License-Identifier: Apache-2.0
// What one block of words asks for, taken together before anything of it is executed.
#include <array>
#include <string>
#include <utility>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {

BlockWords Execution::gather() {
  BlockWords words;
  words.block = &block_;
  std::vector<const GRule*> by_value;
  // G words first: an expression counts by the modes of its block.
  for (std::size_t i = 0, left = block_.g_count; left > 0; ++i) {
    Word& word = block_.words[i];
    if (word.meaning != Meaning::g) continue;
    if (word.value.expression != 0 || word.argument_count != 0) evaluate_words(word);
    gather_g(words, word, by_value);
    --left;
  }
  for (std::size_t i = 0; i < block_.count; ++i) {
    Word& word = block_.words[i];
    if (word.meaning == Meaning::g) continue;
    if (word.value.expression != 0) evaluate_words(word);
    if (word.meaning == Meaning::axis) {
      if (word.axis < 0) continue;  // the language judges it
      refuse_barred(word.axis, word.column);
      if (word.value.bare && !dialect_.lexis.bare_is_zero &&
          (words.instead_word == nullptr || words.instead_word->g == nullptr ||
           !words.instead_word->g->names_axes))
        fail(Fault::value_missing, word.column, {std::string(1, word.letter), std::string(1, word.letter)});
      words.axis[static_cast<std::size_t>(word.axis)] = &word;
      ++words.axes;
    } else {
      gather_word(words, word);
    }
  }
  if (dialect_.arrange != nullptr) dialect_.arrange(*this, words);
  if (words.has_centres && (words.instead == nullptr || dialect_.arrange == nullptr))
    for (std::size_t i = 0; i < block_.count; ++i)
      if (block_.words[i].meaning == Meaning::centre_of) gather_centre(words, block_.words[i]);
  return words;
}

/// What the expressions of a word give takes the place of its number, in the block's order.
void Execution::evaluate_words(Word& word) {
  const auto take = [this](Value& value) {
    if (value.expression == 0) return;
    std::size_t pos = value.expression - 1u;
    const double number = evaluate(pos);
    value.number = value.negative ? -number : number;
  };
  take(word.value);
  if (word.argument_count != 0)
    for (std::size_t i = 0; i < word.argument_count; ++i) take(block_.arguments[i]);
  if (word.letter == 0 || word.value.expression == 0) return;
  const LetterRule& rule = dialect_.letters[static_cast<unsigned char>(word.letter)];
  if (rule.min < rule.max && !(word.value.number >= rule.min && word.value.number <= rule.max))
    fail(Fault::out_of_range, word.column,
         {std::string(1, word.letter), text::number(word.value.number), text::number(rule.min),
          text::number(rule.max)});
}

void Execution::gather_g(BlockWords& words, const Word& word, std::vector<const GRule*>& by_value) {
  const GRule* rule = word.g;
  if (rule == nullptr) {
    const int number = numbers_.whole(word.value, "G");
    rule = dialect_.find_g(number);
    if (rule == nullptr) fail(Fault::g_unknown, word.column, {g_name(number)});
  }
  if (word.g == nullptr || !by_value.empty()) {
    // A number that is known only now: what reading could not judge is judged against all of the block.
    if (by_value.empty())
      for (const Word* other = block_.words.data(); other != &word; ++other)
        if (other->meaning == Meaning::g) by_value.push_back(other->g);
    by_value.push_back(rule);
    check_parameter_g(by_value, word);
  }
  take_g(words, *rule);
  if (rule->take != nullptr) rule->take(*this, words, word);
  if (rule->function == Function::cycle) words.cycle_word = &word;
  if (rule->function == Function::dwell) words.dwell_word = &word;
  if (rule->function == Function::spindle_mark) words.mark_word = &word;
  if (rule->function == Function::own) {
    words.instead = rule->motion;
    words.instead_word = &word;
  }
  if (word.argument_count != 0 && rule->function != Function::own && rule->take == nullptr)
    fail(Fault::not_executed, word.column,
         {std::string(block_.line.substr(word.column - 1u, word.end - word.column + 1u))});
}

void Execution::gather_word(BlockWords& words, const Word& word) {
  if (word.meaning >= Meaning::factor_1 && word.meaning <= Meaning::factor_3) {
    words.factor[static_cast<std::size_t>(word.meaning) - static_cast<std::size_t>(Meaning::factor_1)] =
        &word;
    words.has_factors = true;
    return;
  }
  static constexpr std::array<std::pair<Meaning, const Word * BlockWords::*>, 12> kPlaces = {{
      {Meaning::centre_1, &BlockWords::centre1},
      {Meaning::centre_2, &BlockWords::centre2},
      {Meaning::pitch, &BlockWords::pitch},
      {Meaning::feed, &BlockWords::feed},
      {Meaning::block_time, &BlockWords::time},
      {Meaning::speed, &BlockWords::speed},
      {Meaning::tool, &BlockWords::tool},
      {Meaning::corrector, &BlockWords::corrector},
      {Meaning::h, &BlockWords::h},
      {Meaning::count, &BlockWords::count},
      {Meaning::angle, &BlockWords::angle},
      {Meaning::amount, &BlockWords::amount},
  }};
  switch (word.meaning) {
    case Meaning::m: {
      const int code = numbers_.whole(word.value, "M");
      const LetterRule& rule = dialect_.letters['M'];
      if (code > rule.max)
        fail(Fault::out_of_range, word.value.column,
             {"M", std::to_string(code), "0", text::number(rule.max)});
      const MRule* known = dialect_.find_m(code);
      if (known != nullptr && known->action == MAction::later)
        fail(Fault::not_executed, word.column, {"M" + std::to_string(code)});
      if (known != nullptr && known->action == MAction::own) return gather_own(words, word);
      if (known != nullptr && known->action == MAction::spindle_orient) words.counts_as_motion = true;
      words.m[static_cast<std::size_t>(words.m_count)] = &word;
      words.m_code[static_cast<std::size_t>(words.m_count++)] = code;
      return;
    }
    case Meaning::radius:
      (words.radius == nullptr ? words.radius : words.radius2) = &word;
      return;
    case Meaning::statement:
      return gather_statement(words, word);
    case Meaning::centre_of:
      words.has_centres = true;
      return;
    case Meaning::count:
    case Meaning::angle:
    case Meaning::amount:
      words.for_instead = true;
      break;
    default:
      break;
  }
  for (const auto& [meaning, place] : kPlaces)
    if (meaning == word.meaning) words.*place = &word;
}

/// Which centre of the plane a word of an axis is; known once the block's planes and axes are.
void Execution::gather_centre(BlockWords& words, const Word& word) const {
  if (word.axis == state_.frames.axis1)
    words.centre1 = &word;
  else if (word.axis == state_.frames.axis2)
    words.centre2 = &word;
  else
    fail(Fault::word_without_function, word.column, {word_text(dialect_, block_, word)});
}

void Execution::gather_statement(BlockWords& words, const Word& word) {
  const WordRule& rule = *word.rule;
  if (rule.when == When::in_order) return rule.run(*this, word);
  if (rule.when == When::for_motion) {
    if (words.instead != nullptr) fail(Fault::word_without_function, word.column, {std::string(rule.name)});
    words.instead = rule.motion;
    words.instead_word = &word;
    return;
  }
  if (static_cast<std::size_t>(words.statement_count) == words.statements.size())
    fail(Fault::too_many_words, word.column, {std::to_string(words.statements.size())});
  words.statements[static_cast<std::size_t>(words.statement_count++)] = &word;
}

void Execution::check_parameter_g(const std::vector<const GRule*>& rules, const Word& last) const {
  const GRule& second = *rules.back();
  for (std::size_t i = 0; i + 1 < rules.size(); ++i)
    if (rules[i]->group == second.group || dialect_.conflict(rules[i]->number, second.number))
      fail(Fault::g_conflict, last.column, {g_name(rules[i]->number), g_name(second.number)});
  if (second.function == Function::later)
    fail(Fault::not_executed, last.column, {"G" + g_name(second.number)});
}

}  // namespace servogate::program
