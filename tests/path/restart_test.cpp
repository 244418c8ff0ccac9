// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {
namespace {

Element line_to(double x) {
  Element e;
  e.kind = Element::Kind::line;
  e.to[0] = x;
  e.feed = 100.0;
  return e;
}

TEST(Restart, keeps_the_new_path_that_becomes_visible_together_with_it_after_a_stop) {
  Config config;
  for (auto& limits : config.limits) limits = {500.0, 1000.0, 10000.0};
  Track track(config);
  Planner planner(config, track);
  Follower follower(config, track);
  planner.restart({});
  planner.add(line_to(200.0));
  planner.finish();
  planner.work();
  for (int i = 0; i < 300; ++i) follower.step(track.visible());
  follower.stop();
  Sample sample;
  for (int i = 0; i < 1000 && sample.state != FollowerState::stopped; ++i)
    sample = follower.step(track.visible());
  ASSERT_EQ(sample.state, FollowerState::stopped);

  planner.restart(sample.position);
  planner.add(line_to(5.0));
  planner.finish();
  planner.work();  // restart and path are there at once, as a quick reader makes them
  for (int i = 0; i < 3000 && sample.position[0] != 5.0; ++i) sample = follower.step(track.visible());
  EXPECT_EQ(sample.position[0], 5.0);
  EXPECT_EQ(sample.starved, 0u);
}

}  // namespace
}  // namespace servogate::path
