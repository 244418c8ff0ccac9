// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/counting/allocations.hpp"
#include "tests/path/rig/trip.hpp"

namespace servogate::path::test {
namespace {

TEST(RealTime, a_step_allocates_nothing_whatever_happens_in_it) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomProgram p = random_program(seed, {10, true, true});
    Track track(p.config);
    Planner planner(p.config, track);
    Follower follower(p.config, track);
    follower.set_position(p.start);
    planner.restart(p.start);
    for (const Element& e : p.elements) planner.add(e);
    planner.add_event(1, {});
    planner.finish();
    for (int cycle = 0; cycle < 3000; ++cycle) {
      planner.work();
      const std::uint64_t before = counting::allocations();
      if (cycle % 300 == 100) follower.hold();
      if (cycle % 300 == 250) follower.resume();
      if (cycle % 70 == 0) follower.set_override(0.2 + 0.01 * (cycle % 130));
      if (cycle == 2500) follower.stop();
      follower.release_stop();
      follower.release_event();
      const Sample s = follower.step(track.visible());
      ASSERT_EQ(counting::allocations(), before)
          << "cycle " << cycle << " state " << static_cast<int>(s.state);
    }
  }
}

TEST(RealTime, the_count_of_allocations_counts) {
  const std::uint64_t before = counting::allocations();
  int* volatile memory = new int(1);  // volatile: the compiler may otherwise leave the pair out
  delete memory;
  EXPECT_EQ(counting::allocations(), before + 1);
}

}  // namespace
}  // namespace servogate::path::test
