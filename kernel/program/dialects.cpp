// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernel/program/fenix/fenix.hpp"
#include "kernel/program/nc110/nc110.hpp"
#include "kernel/program/sinumerik/sinumerik.hpp"

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

}  // namespace servogate::program
