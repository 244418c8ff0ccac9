// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "tests/path/rig/trip.hpp"
#include "tests/path/rig/turning_spindle.hpp"

namespace servogate::path::test {

inline Config lathe() {
  Config c = mill();
  c.threads.retract = {2.0, 0.0, 0.0};
  return c;
}

inline Element thread_to(double x, double z, double lead, double rpm = 600.0, double start = 0.0) {
  Element e = line_to(x, 0.0, z, 0.0, 0.02);
  e.transition.continuation = Continuation::continuous;
  e.lock = {Lock::Kind::thread, lead, 0.0, start};
  e.revolutions = rpm / 60.0;
  e.feed = lead * e.revolutions;
  return e;
}

/// Planner, follower and a spindle in one loop.
struct Lathe {
  explicit Lathe(const Config& c = lathe()) : config(c), track(c), planner(c, track), follower(c, track) {
    planner.restart({});
    trip.samples.emplace_back();
  }
  void add(const Element& e) { ASSERT_TRUE(planner.add(e)); }
  const Sample& step() {
    planner.work();
    follower.set_spindle(spindle.wanted);
    follower.set_master(spindle.reading());
    trip.samples.push_back(follower.step(track.visible()));
    spindle.step();
    const Sample& s = trip.samples.back();
    if (s.master.locked && lead != 0.0) {
      // Where the true angle of this moment says Z is, but for whole revolutions.
      const double turns = std::abs(s.position[2] - from) / lead, angle = sign * spindle.n - start;
      const double off = turns - angle;
      worst_mm = std::max(worst_mm, std::abs(off - std::round(off)) * lead);
      ++locked;
    }
    return s;
  }
  bool until(const std::function<bool(const Sample&)>& met, int cycles = 200000) {
    for (; cycles > 0; --cycles)
      if (met(step())) return true;
    return false;
  }
  bool finish() {
    planner.finish();
    return until([](const Sample& s) { return s.state == FollowerState::idle; });
  }
  /// Until the thread is locked and has gone some way.
  void into_thread(double z = -20.0) {
    planner.finish();
    ASSERT_TRUE(until([&](const Sample& s) { return s.master.locked && s.position[2] < z; }));
  }
  std::string why() const {
    for (const Sample& s : trip.samples)
      if (s.master.fault != MasterFault::none)
        return "fault " + std::to_string(static_cast<int>(s.master.fault)) + " " +
               std::to_string(s.master.value) + ", limit " + std::to_string(s.master.limit);
    return "no fault";
  }
  double limits() const { return worst(trip, config).most(); }
  Config config;
  Track track;
  Planner planner;
  Follower follower;
  TurningSpindle spindle;
  Trip trip;
  double lead = 0.0, from = 0.0, start = 0.0, sign = 1.0, worst_mm = 0.0;
  int locked = 0;
};

}  // namespace servogate::path::test
