// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "tests/path/rig.hpp"

namespace {

thread_local bool counting = false;
thread_local int allocations = 0;

void* allocate(std::size_t size) {
  if (counting) ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

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
      counting = true;
      if (cycle % 300 == 100) follower.hold();
      if (cycle % 300 == 250) follower.resume();
      if (cycle % 70 == 0) follower.set_override(0.2 + 0.01 * (cycle % 130));
      if (cycle == 2500) follower.stop();
      follower.release_stop();
      follower.release_event();
      const Sample s = follower.step(track.visible());
      counting = false;
      ASSERT_EQ(allocations, 0) << "cycle " << cycle << " state " << static_cast<int>(s.state);
    }
  }
}

TEST(RealTime, the_count_of_allocations_counts) {
  counting = true;
  delete new int(1);
  counting = false;
  EXPECT_EQ(allocations, 1);
  allocations = 0;
}

}  // namespace
}  // namespace servogate::path::test
