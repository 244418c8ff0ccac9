// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/played_value.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "drivers/mock/world/world.hpp"

namespace servogate::gateway {

namespace {

/// The place of a point holds no fractions.
bool whole_place(const machine::PointConfig& point) { return point.place.format < image::Format::re; }

}  // namespace

image::NumberRange range_of(const machine::PointConfig& point) {
  if (!point.is_analog()) return {0.0, 1.0};
  const image::NumberRange place = image::number_range(point.place.format);
  // A register, or the counter of an encoder.
  const double last =
      point.is_encoder() ? std::numeric_limits<std::int32_t>::max() : mock::World::kLargestRegister;
  const double first = point.is_encoder() ? std::numeric_limits<std::int32_t>::min() : 0.0;
  const double begin = first * point.scale + point.shift, end = last * point.scale + point.shift;
  return {std::max(place.min, std::min(begin, end)), std::min(place.max, std::max(begin, end))};
}

std::pair<double, double> next_to(const machine::PointConfig& point, double value) {
  if (whole_place(point) && std::abs(point.scale) < 1.0) return {std::floor(value), std::ceil(value)};
  if (point.scale == 0.0) return {point.shift, point.shift};
  const double raw = (value - point.shift) / point.scale;
  const auto of = [&](double counts) {
    const double shown = counts * point.scale + point.shift;
    return whole_place(point) ? std::round(shown) : shown;
  };
  return std::minmax({of(std::floor(raw)), of(std::ceil(raw))});
}

bool is_whole(const machine::PointConfig& point) {
  return whole_place(point) ||
         (point.scale == std::floor(point.scale) && point.shift == std::floor(point.shift));
}

}  // namespace servogate::gateway
