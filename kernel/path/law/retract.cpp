// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/retract.hpp"

#include <algorithm>
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

/// With its sign; 0: the axis has no way.
double Retract::distance(const Config& config, const Lock& lock, const Path& path, int axis) noexcept {
  const auto i = static_cast<std::size_t>(axis);
  const double wanted = config.threads.retract[i];
  if (wanted == 0.0 || (lock.stays >> axis & 1u) != 0) return 0.0;
  const double sign = ((wanted < 0.0) != ((lock.against >> axis & 1u) != 0)) ? -1.0 : 1.0;
  const double beside = std::abs(path.along[i]) * path.way;  // what the path may take of the room
  const double room =
      sign > 0.0 ? config.threads.travel_max[i] - path.at[i] : path.at[i] - config.threads.travel_min[i];
  return sign * std::clamp(room - beside, 0.0, std::abs(wanted));
}

void Retract::begin(const Config& config, const Lock& lock, const Path& path) noexcept {
  count_ = 0;
  for (int i = 0; i < config.axis_count; ++i) {
    const double distance = Retract::distance(config, lock, path, i);
    if (distance == 0.0) continue;
    Way& way = ways_[static_cast<std::size_t>(count_)];
    distance_[static_cast<std::size_t>(count_++)] = std::abs(distance);
    way = {};
    way.axis = i;
    way.sign = distance < 0.0 ? -1.0 : 1.0;
    const AxisLimits& all = config.limits[static_cast<std::size_t>(i)];
    const double share = std::abs(path.along[static_cast<std::size_t>(i)]);
    const AxisLimits left{all.velocity - share * path.box.velocity,
                          all.acceleration - share * path.box.acceleration, all.jerk - share * path.box.jerk};
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
