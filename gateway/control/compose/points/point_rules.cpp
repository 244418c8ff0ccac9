// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/points/point_rules.hpp"

#include <cmath>

namespace servogate::gateway {

image::PointRule point_rule(const machine::PointConfig& p) {
  image::PointRule rule;
  rule.place = p.place;
  rule.input = p.is_input();
  rule.digital = !p.is_analog();
  rule.inverted = p.inverted;
  rule.hold = p.hold || p.is_encoder();  // a jump of its counts would be a motion
  rule.loss = p.loss;
  rule.scale = p.scale;
  rule.shift = p.shift;
  rule.debounce_ns = static_cast<image::Nanoseconds>(std::llround(p.debounce * 1e9));
  rule.hysteresis = p.hysteresis;
  return rule;
}

std::vector<image::PointRule> point_rules(const machine::StationConfig& station) {
  std::vector<image::PointRule> rules;
  for (const machine::PointConfig& p : station.points) rules.push_back(point_rule(p));
  return rules;
}

}  // namespace servogate::gateway
