// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/dialect.hpp"

#include <algorithm>

namespace servogate::program {
namespace {

template <typename Table, typename Key, typename Field>
auto find_in(const Table& table, const Key& key, Field field) {
  const auto at =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.*field == key; });
  return at == table.end() ? nullptr : &*at;
}

bool same_letters(std::string_view written, std::string_view name) {
  return std::equal(written.begin(), written.end(), name.begin(), name.end(), [](char a, char b) {
    return (a >= 'a' && a <= 'z' ? static_cast<char>(a - 'a' + 'A') : a) == b;
  });
}

}  // namespace

std::string g_name(int number) {
  if (number < kPointInG) return std::to_string(number);
  return std::to_string(number % kPointInG) + "." + std::to_string(number / kPointInG);
}

const GRule* Dialect::find_g(int number) const noexcept {
  const GRule* rule = find_in(g, number, &GRule::number);
  return rule == nullptr ? other_g : rule;
}
const MRule* Dialect::find_m(int code) const noexcept { return find_in(m, code, &MRule::code); }
const WordRule* Dialect::find_word(std::string_view word) const noexcept {
  const auto at = std::find_if(words.begin(), words.end(),
                               [&](const WordRule& row) { return same_letters(word, row.name); });
  return at == words.end() ? nullptr : &*at;
}
const VariableRule* Dialect::find_variable(std::string_view variable) const noexcept {
  return find_in(variables, variable, &VariableRule::name);
}
const text::Entry* Dialect::own(const text::Entry* shared) const noexcept {
  for (const OwnError& row : errors)
    if (shared == &program::entry(row.fault)) return &row.entry;
  return shared;
}
const WordRule* Dialect::word_of(Meaning meaning) const noexcept {
  return find_in(words, meaning, &WordRule::meaning);
}
char Dialect::letter_of(Meaning meaning) const noexcept {
  const auto at = std::find_if(letters.begin(), letters.end(),
                               [&](const LetterRule& rule) { return rule.meaning == meaning; });
  return at == letters.end() ? '\0' : static_cast<char>(at - letters.begin());
}

}  // namespace servogate::program
