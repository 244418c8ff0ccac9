// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/path_time.hpp"

#include <gtest/gtest.h>

#include "tests/path/rig/random_program.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

double time_of(const RandomProgram& p) {
  PathTime time(p.config, p.start);
  for (const Element& e : p.elements) EXPECT_TRUE(time.add(e));
  time.rest();
  return time.seconds();
}

TEST(PathTime, of_a_line_is_that_of_its_s_curve) {
  // 100 mm at 1000 mm/s2 and 10 000 mm/s3 peak at 270.2 mm/s: 2 (0.2702 + 0.1) s.
  PathTime time(mill(), {});
  ASSERT_TRUE(time.add(line_to(100, 0, 0, 500)));
  time.rest();
  EXPECT_NEAR(0.7403, time.seconds(), 0.001);
  time.rest();
  EXPECT_NEAR(0.7403, time.seconds(), 0.001) << "resting takes no time";
}

TEST(PathTime, names_the_flaw_and_goes_on_as_if_the_element_had_not_been) {
  PathTime time(mill(), {});
  EXPECT_FALSE(time.add(line_to(100, 0, 0, 0)));
  EXPECT_EQ(Flaw::no_feed, time.last_flaw());
  EXPECT_TRUE(time.add(line_to(100, 0, 0, 500)));
  time.rest();
  EXPECT_NEAR(0.7403, time.seconds(), 0.001);
}

TEST(PathTime, of_elements_from_rest_to_rest_is_that_of_the_follower_within_a_hundredth) {
  const std::uint64_t first = servogate::test::property_seed();
  for (std::uint64_t n = 0; n < 60; ++n) {
    ProgramShape shape;
    shape.elements = n % 3 == 0 ? 200 : 12;
    RandomProgram p = random_program(first + n, shape);
    for (Element& e : p.elements) {  // the time of courses is about: forecast_test.cpp
      if (e.kind == Element::Kind::arc) e.kind = Element::Kind::line;
      e.transition.continuation = Continuation::exact_stop;
    }
    const Estimate driven = estimate(p.config, p.start, p.elements);
    // Each stop costs a cycle until the follower goes on.
    const double stops = 2.0 * p.config.period_s * static_cast<double>(p.elements.size());
    EXPECT_NEAR(driven.seconds, time_of(p), 0.01 * driven.seconds + stops) << "seed " << first + n;
  }
}

TEST(PathTime, of_more_pieces_than_the_track_holds_is_whole) {
  RandomProgram p;
  p.config = mill();
  for (int k = 1; k <= 30'000; ++k) p.elements.push_back(line_to(k % 2, 1e-4 * k, 0, 100));
  EXPECT_NEAR(estimate(p.config, p.start, p.elements).seconds, time_of(p), 1.0);
}

}  // namespace
}  // namespace servogate::path::test
