// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>

#include "machine/config.hpp"

namespace servogate::gateway {

/// What a point of a mock station can be, in the point's own units: what a register holds, as far as its
/// place in the packet holds it; 0 to 1 of a digital one.
image::NumberRange range_of(const machine::PointConfig& point);

/// What an analog point can be below and above a value of that range, the same twice where it can be the
/// value.
std::pair<double, double> next_to(const machine::PointConfig& point, double value);

/// An analog point without fractions, where a person means what he writes; of others the nearest step does.
bool is_whole(const machine::PointConfig& point);

}  // namespace servogate::gateway
