// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/values/parameters.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "kernel/program/messages.hpp"

namespace servogate::program {

const Parameters::Range& Parameters::range(Type type) noexcept {
  static constexpr double kFloat = static_cast<double>(std::numeric_limits<float>::max());
  static constexpr double kDouble = std::numeric_limits<double>::max();
  static constexpr Range kRanges[] = {{"BY", 0, 255},
                                      {"IN", -32768, 32767},
                                      {"LI", -2147483648.0, 2147483647},
                                      {"RE", -kFloat, kFloat},
                                      {"LR", -kDouble, kDouble}};
  return kRanges[static_cast<int>(type)];
}

void Parameters::check(int index, int column) const {
  if (index >= count_) fail(Fault::parameter_absent, column, {std::to_string(index), std::to_string(last())});
}

double Parameters::get(int index, int column) const {
  check(index, column);
  return static_cast<std::size_t>(index) < values_.size() ? values_[static_cast<std::size_t>(index)] : 0.0;
}

void Parameters::set(int index, double value, int column) {
  check(index, column);
  const Type kind = type(index);
  const Range& r = range(kind);
  const double stored = kind <= Type::li ? std::nearbyint(value) : value;
  if (!(stored >= r.min && stored <= r.max))
    fail(Fault::parameter_range, column,
         {text::number(value), std::to_string(index), std::string(r.name), text::number(r.min),
          text::number(r.max)});
  if (static_cast<std::size_t>(index) >= values_.size())
    values_.resize(static_cast<std::size_t>(index) + 1, 0.0);
  values_[static_cast<std::size_t>(index)] =
      kind == Type::re ? static_cast<double>(static_cast<float>(stored)) : stored + 0.0;
}

}  // namespace servogate::program
