// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"

namespace servogate::program::nc110::code {
namespace {

ProtectedZone& zone_of(Execution& run, const Operands& operands, int& number) {
  auto& zones = run.state().frames.zones;
  const Value& value = operands.items[0].value;
  number = run.numbers().whole(value, operands.rule->name);
  if (number < 1 || number > static_cast<int>(zones.size()))
    fail(Wrong::zone_number, value.column, {std::string(operands.rule->name), std::to_string(zones.size())});
  return zones[static_cast<std::size_t>(number) - 1];
}

void activate(Execution& run, const Operands& operands, bool on) {
  int number = 0;
  ProtectedZone& zone = zone_of(run, operands, number);
  if (on && !zone.defined)
    fail(Wrong::zone_missing, operands.items[0].value.column, {std::to_string(number)});
  zone.active = on;
  FramesState& frames = run.state().frames;
  frames.zones_active =
      std::any_of(frames.zones.begin(), frames.zones.end(), [](const auto& z) { return z.active; });
}

}  // namespace

/// Bounds relative to the origin in force.
void dsa(Execution& run, const Operands& operands) {
  int number = 0;
  ProtectedZone& zone = zone_of(run, operands, number);
  ProtectedZone defined;
  defined.defined = true;
  for (std::size_t i = 0; i < 2; ++i) {
    const Operand& item = operands.items[i + 1];
    const double origin = run.state().frames.frame.origin(item.axis);
    const double a = origin + run.numbers().length(item.axis, item.value),
                 b = origin + run.numbers().length(item.axis, item.second);
    defined.axis[i] = item.axis;
    defined.low[i] = std::min(a, b);
    defined.high[i] = std::max(a, b);
  }
  defined.active = zone.active;
  zone = defined;
}

void asc(Execution& run, const Operands& operands) { activate(run, operands, true); }
void dsc(Execution& run, const Operands& operands) { activate(run, operands, false); }

}  // namespace servogate::program::nc110::code
