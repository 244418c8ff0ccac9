// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/frames/numbers.hpp"

#include <cmath>
#include <string>

namespace servogate::program {

Numbers::Numbers(const Dialect& dialect, const MachineModel& machine, const Modes& modes,
                 const Parameters& parameters)
    : dialect_(dialect), machine_(machine), modes_(modes), parameters_(parameters) {
  const double resolution = machine.variable("RESOLUTION", 0.0001);
  resolution_ = resolution > 0.0 ? std::round(1.0 / resolution) : 0.0;
}

double Numbers::resolve(const Value& value) const {
  if (value.parameter < 0) return value.number;
  const double number = parameters_.get(value.parameter, value.column);
  return value.negative ? -number : number;
}

int Numbers::whole(const Value& value, std::string_view word) const {
  const double number = resolve(value);
  if (!(number >= 0.0 && number <= 1e9) || number != std::floor(number))
    fail(Fault::whole_number, value.column, {std::string(word), text::number(number)});
  return static_cast<int>(number);
}

double Numbers::unit_factor(int axis) const noexcept {
  return modes_.unit == Function::inch && !machine_.rotary(axis) ? 25.4 : 1.0;
}

void Numbers::refuse_range(std::string_view word, const Value& value, double number, const char* least,
                           const char* most) const {
  std::string named(word);
  if (value.parameter >= 0)
    named += (value.negative ? " = -" : " = ") + dialect_.parameters.name_of(value.parameter) + " = ";
  fail(Fault::out_of_range, value.column, {std::move(named), text::number(number), least, most});
}

bool Numbers::as_diameter(const Value& value) const noexcept {
  if (modes_.across != Function::diameter_absolute) return modes_.across == Function::diameter;
  return value.dimension == Dimension::as_modes ? modes_.dimension == Function::absolute
                                                : value.dimension == Dimension::absolute;
}

double Numbers::length(int axis, const Value& value, bool halve) const {
  double number = resolve(value);
  const MachineModel::Axis& a = machine_.axes[static_cast<std::size_t>(axis)];
  if (!(std::abs(number) <= 99999.9999)) refuse_range(a.letter, value, number, "-99999.9999", "99999.9999");
  const double steps = a.rotary ? resolution_ * 10.0 : resolution_;
  if (steps != 0.0) number = std::nearbyint(number * steps) / steps;
  number *= unit_factor(axis);
  return halve && a.diameter && as_diameter(value) ? number / 2.0 : number;
}

}  // namespace servogate::program
