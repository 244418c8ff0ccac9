// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/values/parameters.hpp"

#include <cmath>
#include <limits>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program {

std::string ParameterSet::name_of(int index) const {
  return name != nullptr ? name(index) : std::string(letter) + std::to_string(index);
}

Parameters::Parameters(const ParameterSet& set, int count) : set_(&set), count_(count) {}

void Parameters::check(int index, int column) const {
  if (index < 0 || index >= count_)
    fail(Fault::parameter_absent, column, {set_->name_of(index), set_->name_of(last())});
}

double Parameters::get(int index, int column) const {
  check(index, column);
  const auto i = static_cast<std::size_t>(index);
  const double value = i < values_.size() ? values_[i] : std::nan("");
  if (!std::isnan(value)) return value;
  if (set_->must_be_set) fail(Fault::parameter_unset, column, {set_->name_of(index)});
  return 0.0;
}

void Parameters::set(int index, double value, int column) {
  check(index, column);
  const ParameterType* type = &set_->types.front();
  for (const ParameterType& row : set_->types)
    if (row.first <= index) type = &row;
  const double stored = type->whole ? std::nearbyint(value) : value;
  if (!(stored >= type->min && stored <= type->max))
    fail(Fault::parameter_range, column,
         {text::number(value), set_->name_of(index), std::string(type->name), text::number(type->min),
          text::number(type->max)});
  const auto i = static_cast<std::size_t>(index);
  if (i >= values_.size()) values_.resize(i + 1, std::nan(""));
  values_[i] = type->single ? static_cast<double>(static_cast<float>(stored)) : stored + 0.0;
}

}  // namespace servogate::program
