// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/dialect.hpp"

#include <algorithm>

#include "kernel/program/nc110/nc110.hpp"

namespace servogate::program {
namespace {

template <typename Table, typename Key, typename Field>
auto find_in(const Table& table, const Key& key, Field field) {
  const auto at =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.*field == key; });
  return at == table.end() ? nullptr : &*at;
}

}  // namespace

const GRule* Dialect::find_g(int number) const noexcept { return find_in(g, number, &GRule::number); }
const MRule* Dialect::find_m(int code) const noexcept { return find_in(m, code, &MRule::code); }
const CodeRule* Dialect::find_code(std::string_view code) const noexcept {
  return find_in(codes, code, &CodeRule::name);
}
const VariableRule* Dialect::find_variable(std::string_view variable) const noexcept {
  return find_in(variables, variable, &VariableRule::name);
}

std::span<const Dialect* const> all_dialects() {
  static const Dialect* const all[] = {&nc110::dialect()};
  return all;
}

const Dialect* find_dialect(std::string_view name) {
  const auto all = all_dialects();
  const auto at = std::find_if(all.begin(), all.end(), [&](const Dialect* d) { return d->name == name; });
  return at == all.end() ? nullptr : *at;
}

}  // namespace servogate::program
