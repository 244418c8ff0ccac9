// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/retract.hpp"

#include <cmath>

namespace servogate::path {
namespace {

constexpr double kEnough = 0.1;  // of an axis' limits

}  // namespace

void Retract::plan_way(Way& way, double distance, const AxisLimits& limits) noexcept {
  Goal goal;
  goal.length = distance;
  goal.velocity = limits.velocity;
  way.profile.start({});
  plan(way.profile, {}, goal, {limits.velocity, limits.acceleration, limits.jerk});
  way.begun = true;
  way.clock = 0.0;
}

void Retract::begin(const Config& config, const Vector& along, const Box& box) noexcept {
  count_ = 0;
  for (int i = 0; i < config.axis_count; ++i) {
    const double distance = config.threads.retract[static_cast<std::size_t>(i)];
    if (distance == 0.0) continue;
    Way& way = ways_[static_cast<std::size_t>(count_)];
    distance_[static_cast<std::size_t>(count_++)] = std::abs(distance);
    way = {};
    way.axis = i;
    way.sign = distance < 0.0 ? -1.0 : 1.0;
    const AxisLimits& all = config.limits[static_cast<std::size_t>(i)];
    const double share = std::abs(along[static_cast<std::size_t>(i)]);
    const AxisLimits left{all.velocity - share * box.velocity, all.acceleration - share * box.acceleration,
                          all.jerk - share * box.jerk};
    if (left.velocity > kEnough * all.velocity && left.acceleration > kEnough * all.acceleration &&
        left.jerk > kEnough * all.jerk)
      plan_way(way, std::abs(distance), left);
  }
}

void Retract::path_rests(const Config& config) noexcept {
  for (int n = 0; n < count_; ++n)
    if (Way& way = ways_[static_cast<std::size_t>(n)]; !way.begun)
      plan_way(way, distance_[static_cast<std::size_t>(n)],
               config.limits[static_cast<std::size_t>(way.axis)]);
}

void Retract::step(double seconds) noexcept {
  for (int n = 0; n < count_; ++n)
    if (Way& way = ways_[static_cast<std::size_t>(n)]; way.begun) way.clock += seconds;
}

bool Retract::moving() const noexcept {
  for (int n = 0; n < count_; ++n) {
    const Way& way = ways_[static_cast<std::size_t>(n)];
    if (!way.begun || way.clock < way.profile.duration()) return true;
  }
  return false;
}

MotionState Retract::at(int axis) const noexcept {
  for (int n = 0; n < count_; ++n) {
    const Way& way = ways_[static_cast<std::size_t>(n)];
    if (way.axis != axis || !way.begun) continue;
    const MotionState at = way.profile.at(way.clock);
    return {way.sign * at.s, way.sign * at.v, way.sign * at.a};
  }
  return {};
}

}  // namespace servogate::path
