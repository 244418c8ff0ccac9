// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/languages.hpp"

#include <algorithm>

#include "kernel/program/languages/fenix/fenix.hpp"
#include "kernel/program/languages/nc110/nc110.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program {

std::span<const Dialect* const> all_dialects() {
  static const Dialect* const all[] = {&nc110::dialect(), &fenix::dialect(), &sinumerik::dialect()};
  return all;
}

const Dialect* find_dialect(std::string_view name) {
  const auto all = all_dialects();
  const auto at = std::find_if(all.begin(), all.end(), [&](const Dialect* d) { return d->name == name; });
  return at == all.end() ? nullptr : *at;
}

std::string axis_letters(std::string_view dialect) {
  const Dialect* found = find_dialect(dialect);
  std::string letters;
  for (char c = 'A'; found != nullptr && c <= 'Z'; ++c)
    if (found->letters[static_cast<unsigned char>(c)].meaning == Meaning::axis) letters += c;
  return letters;
}

std::vector<std::string> dialects() {
  std::vector<std::string> names;
  for (const Dialect* dialect : all_dialects()) names.emplace_back(dialect->name);
  return names;
}

}  // namespace servogate::program
