// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"
#include "tests/path/rig/trip.hpp"

namespace servogate::path::test {

/// Planner and follower in one loop, as the virtual cycle runs them.
struct DrivenPath {
  explicit DrivenPath(const Config& c = mill()) : config(c), track(c), planner(c, track), follower(c, track) {
    planner.restart({});
    trip.samples.emplace_back();
  }
  Sample step() {
    planner.work();
    last = follower.step(track.visible());
    trip.samples.push_back(last);
    return last;
  }
  /// Steps until the condition holds; false when it does not within 100 s.
  bool until(const std::function<bool(const Sample&)>& condition) {
    for (int k = 0; k < 100000; ++k)
      if (condition(step())) return true;
    return false;
  }
  bool until(FollowerState state) {
    return until([&](const Sample& s) { return s.state == state; });
  }
  double most() const { return worst(trip, config).most(); }
  Config config;
  Track track;
  Planner planner;
  Follower follower;
  Sample last;
  Trip trip;
};

}  // namespace servogate::path::test
