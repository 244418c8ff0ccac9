// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

namespace servogate::program::nc110::code {
namespace {

/// As if its life were over.
void declare_worn_out(Tables::Corrector& tool) {
  constexpr double kShortest = 0.001;  // minutes; a life of 0 means none
  if (tool.life_min <= 0.0) tool.life_min = std::max(tool.used_min, kShortest);
  tool.used_min = std::max(tool.used_min, tool.life_min);
}

/// The wear has gone beyond a limit of the row.
bool beyond(const Tables::Corrector& tool) {
  const auto worn = [&](const auto& limit) {
    const auto wear = tool.wear.find(limit.first);
    return wear != tool.wear.end() && limit.second > 0.0 && std::abs(wear->second) > limit.second;
  };
  return std::any_of(tool.wear_limit.begin(), tool.wear_limit.end(), worn) ||
         (tool.radius_wear_limit > 0.0 && std::abs(tool.radius_wear) > tool.radius_wear_limit);
}

/// Adds to a row of the tool table: to its wear, or to its lengths and radius themselves. K is a diameter, a
/// value of a diameter axis is halved; no scale.
void requalify(Execution& run, const Operands& operands, bool wear) {
  const int number = run.numbers().whole(operands.items[1].value, operands.rule->name);
  auto tables = std::make_shared<Tables>(*run.state().frames.tables);
  const auto row = tables->correctors.find(number);
  if (row == tables->correctors.end())
    fail(Wrong::corrector_number, operands.items[1].value.column,
         {std::string(operands.rule->name), std::to_string(number)});
  Tables::Corrector& corrector = row->second;
  for (std::size_t i = 2; i < operands.count; ++i) {
    const Operand& item = operands.items[i];
    if (item.axis < 0) {
      const double radius =
          run.numbers().resolve(item.value) / 2.0 * (run.state().modes.unit == Function::inch ? 25.4 : 1.0);
      (wear ? corrector.radius_wear : corrector.radius) += radius;
      continue;
    }
    const std::string& letter = run.machine().axes[static_cast<std::size_t>(item.axis)].letter;
    (wear ? corrector.wear : corrector.length)[letter] += run.numbers().length(item.axis, item.value);
  }
  if (wear && beyond(corrector)) declare_worn_out(corrector);
  run.state().frames.tables = std::move(tables);
}

}  // namespace

void rqu(Execution& run, const Operands& operands) { requalify(run, operands, true); }
void rqp(Execution& run, const Operands& operands) { requalify(run, operands, false); }

/// Declares a tool unfit.
void tof(Execution& run, const Operands& operands) {
  const int number = run.numbers().whole(operands.items[0].value, operands.rule->name);
  auto tables = std::make_shared<Tables>(*run.state().frames.tables);
  const auto row = tables->correctors.find(number);
  if (row == tables->correctors.end())
    fail(Wrong::corrector_number, operands.items[0].value.column,
         {std::string(operands.rule->name), std::to_string(number)});
  declare_worn_out(row->second);
  run.state().frames.tables = std::move(tables);
}

/// Approach and safety distance in mm, feed in mm/min.
void dpt(Execution& run, const Operands& operands) {
  constexpr Own kPlaces[] = {Own::approach, Own::safety, Own::probe_feed};
  const double unit = run.state().modes.unit == Function::inch ? 25.4 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = run.numbers().resolve(operands.items[i].value);
    if (!(value > 0.0)) fail(Wrong::probe_parameters, operands.items[i].value.column);
    run.state().own[at(kPlaces[i])] = value * unit;
  }
}

}  // namespace servogate::program::nc110::code
