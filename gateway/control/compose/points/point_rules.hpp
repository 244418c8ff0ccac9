// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/image/points/point_stage.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// A point of the machine file as its source's stage takes it. The same for every kind of station.
image::PointRule point_rule(const machine::PointConfig& point);
/// Those of a station, in its order.
std::vector<image::PointRule> point_rules(const machine::StationConfig& station);

}  // namespace servogate::gateway
