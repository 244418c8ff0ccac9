// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/turning.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

constexpr int kMostPasses = 10'000;

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

/// The place where a cycle began, and the moves from there.
class Plane {
 public:
  Plane(Execution& run, const Turning& cycle)
      : run_(run),
        cycle_(cycle),
        along_(run.state().frames.programmed[static_cast<std::size_t>(cycle.along)]),
        across_(run.state().frames.programmed[static_cast<std::size_t>(cycle.across)]) {}

  double along() const { return along_; }
  double across() const { return across_; }
  void to(double along, double across, bool rapid) {
    Position at = run_.state().frames.programmed;
    at[static_cast<std::size_t>(cycle_.along)] = along;
    at[static_cast<std::size_t>(cycle_.across)] = across;
    run_.motion().go(at, rapid);
  }

 private:
  Execution& run_;
  const Turning& cycle_;
  double along_, across_;
};

/// How many steps lead over `way`, the last one a rest; throws where there are too many.
int steps_of(const Turning& cycle, double way) {
  const double count = std::ceil(std::abs(way) / cycle.step - 1e-6);
  if (!(count <= kMostPasses)) fail(Fault::cycle_pecks, 0, {cycle.name, std::to_string(kMostPasses)});
  return static_cast<int>(count);
}

}  // namespace

void turn_once(Execution& run, const Turning& cycle) {
  Plane plane(run, cycle);
  const double forward = sign(cycle.along_end - plane.along()), out = sign(plane.across() - cycle.across_end);
  plane.to(plane.along(), cycle.across_end, cycle.sets_at_rapid);
  plane.to(cycle.along_end - forward * cycle.bevel_along, cycle.across_end, false);
  plane.to(cycle.along_end, cycle.across_end + out * cycle.bevel_across, false);
  plane.to(cycle.along_end, plane.across(), false);
  plane.to(plane.along(), plane.across(), true);
}

void turn_rough(Execution& run, const Turning& cycle) {
  Plane plane(run, cycle);
  const double way = cycle.across_end - plane.across(), in = sign(way);
  const double forward = sign(cycle.along_end - plane.along());
  const int passes = steps_of(cycle, way);
  for (int pass = 1; pass < passes; ++pass) {
    const double depth = plane.across() + in * pass * cycle.step;
    const double end = cycle.along_end - forward * cycle.bevel_along * (depth - plane.across()) / way;
    const double away = depth - in * std::min(cycle.clearance, pass * cycle.step);
    plane.to(plane.along(), depth, cycle.sets_at_rapid);
    plane.to(end, depth, false);
    plane.to(end, away, cycle.sets_at_rapid);
    plane.to(plane.along(), away, true);
    plane.to(plane.along(), plane.across(), cycle.sets_at_rapid);
  }
  plane.to(plane.along(), cycle.across_end, cycle.sets_at_rapid);
  plane.to(cycle.along_end - forward * cycle.bevel_along, cycle.across_end, false);
  plane.to(cycle.along_end, plane.across(), false);
  plane.to(plane.along(), plane.across(), true);
}

void turn_pecks(Execution& run, const Turning& cycle) {
  Plane plane(run, cycle);
  const double way = cycle.along_end - plane.along(), forward = sign(way);
  const int pecks = steps_of(cycle, way);
  double bottom = plane.along();
  for (int peck = 1; peck <= pecks; ++peck) {
    const double clearance = std::min(cycle.clearance, std::abs(bottom - plane.along()));
    if (peck > 1) plane.to(bottom - forward * clearance, plane.across(), true);
    bottom = peck == pecks ? cycle.along_end : plane.along() + forward * peck * cycle.step;
    plane.to(bottom, plane.across(), false);
    plane.to(plane.along(), plane.across(), true);
  }
}

void turn_grooves(Execution& run, const Turning& cycle) {
  Plane plane(run, cycle);
  const double way = cycle.across_end - plane.across();
  const int steps = steps_of(cycle, way);
  for (int groove = 0; groove <= steps; ++groove) {
    const double across =
        groove == steps ? cycle.across_end : plane.across() + sign(way) * groove * cycle.step;
    if (groove > 0) plane.to(plane.along(), across, cycle.sets_at_rapid);
    plane.to(cycle.along_end, across, false);
    plane.to(plane.along(), across, true);
  }
}

}  // namespace servogate::program
