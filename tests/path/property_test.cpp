// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/path/rig/trip.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

int cases() {
  if (const char* given = std::getenv("SERVOGATE_PROPERTY_CASES")) return std::atoi(given);
  return 300;
}

Scenario scenario(std::uint64_t seed) {
  Scenario s;
  s.seed = seed;
  s.overrides = (seed & 1) != 0;
  s.holds = (seed & 2) != 0;
  s.starving = (seed & 4) != 0;
  s.late = (seed & 8) != 0;
  s.disturbed = 500;
  return s;
}

TEST(RandomPrograms, keep_every_limit_the_tolerance_and_the_end_point_whatever_happens) {
  const std::uint64_t base = servogate::test::property_seed("SERVOGATE_MOTION_SEED");
  int wrong = 0;
  Worst reached;
  std::size_t cycles = 0;
  for (int k = 0; k < cases() && wrong < 10; ++k) {
    const std::uint64_t seed = base + static_cast<std::uint64_t>(k);
    const RandomProgram program = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    const Trip r = run(program, scenario(seed));
    Worst w;
    const std::string text = verdict(r, program, &w);
    if (!text.empty()) {
      ADD_FAILURE() << "seed " << seed << ": " << text << " (" << program.elements.size() << " elements)";
      ++wrong;
    }
    reached = {std::max(reached.velocity, w.velocity), std::max(reached.acceleration, w.acceleration),
               std::max(reached.jerk, w.jerk)};
    cycles += r.samples.size();
  }
  std::printf("%zu cycles, largest share of a limit: v %.6f a %.6f j %.6f\n", cycles, reached.velocity,
              reached.acceleration, reached.jerk);
}

TEST(RandomPrograms, on_slow_axes_keep_the_velocity_when_held_while_speeding_up) {
  for (const std::uint64_t first : {90000652u, 90000744u, 90001490u, 90001807u, 90003028u}) {
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
      RandomProgram program = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
      for (AxisLimits& limits : program.config.limits) limits.velocity *= 0.05;
      Scenario s = scenario(seed);
      s.holds = true;
      s.disturbed = 3000;
      EXPECT_EQ(verdict(run(program, s), program), "") << seed;
    }
  }
}

TEST(RandomPrograms, end_after_a_hold_that_rests_a_rounding_error_before_the_end_of_a_block) {
  // The last picometre was driven at 1e-19 mm/s, for hours.
  for (const std::uint64_t seed : {1795318917929931706u}) {
    const RandomProgram program = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    EXPECT_EQ(verdict(run(program, scenario(seed)), program), "") << seed;
  }
}

TEST(RandomPrograms, end_behind_a_long_line_at_the_velocity_of_its_axis) {
  // The first clock of the run behind the cruise went on faster in a step, and no law was found for it.
  for (const std::uint64_t seed : {1795664895866841694u}) {
    const RandomProgram program = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    EXPECT_EQ(verdict(run(program, scenario(seed)), program), "") << seed;
  }
}

TEST(RandomPrograms, of_many_short_blocks_keep_them_too_when_held_over_and_over) {
  const std::uint64_t base = servogate::test::property_seed();
  int wrong = 0;
  for (int k = 0; k < cases() / 50 && wrong < 10; ++k) {
    const std::uint64_t seed = base + static_cast<std::uint64_t>(k);
    RandomProgram program = random_program(seed, {120, false, false});
    for (Element& e : program.elements) e.feed = std::max(e.feed, 60.0);  // so that it ends in minutes
    Scenario s = scenario(seed | 3);
    s.disturbed = 4000;
    const std::string text = verdict(run(program, s), program);
    if (!text.empty()) {
      ADD_FAILURE() << "seed " << seed << ": " << text << " (" << program.elements.size() << " elements)";
      ++wrong;
    }
  }
}

}  // namespace
}  // namespace servogate::path::test
