// SPDX-License-Identifier: Apache-2.0
// The judge of the property tests is judged itself.
#include "tests/path/rig/frechet.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {
namespace {

const Polyline kStraight{{0, 0}, {10, 0}};

TEST(Frechet, is_the_offset_of_parallel_lines) {
  const Polyline other{{0, 0.5}, {3, 0.5}, {10, 0.5}};
  EXPECT_TRUE(frechet_within(kStraight, other, 0.5001, 2));
  EXPECT_FALSE(frechet_within(kStraight, other, 0.4999, 2));
  EXPECT_TRUE(frechet_within(other, kStraight, 0.5001, 2));
  EXPECT_FALSE(frechet_within(other, kStraight, 0.4999, 2));
}

TEST(Frechet, sees_a_way_back_and_forth_that_a_distance_of_points_does_not) {
  const Polyline wanders{{0, 0}, {7, 0}, {3, 0}, {10, 0}};  // has to be matched at 5 +- 2
  EXPECT_TRUE(frechet_within(wanders, kStraight, 2.001, 2));
  EXPECT_FALSE(frechet_within(wanders, kStraight, 1.999, 2));
  EXPECT_FALSE(frechet_within(kStraight, wanders, 1.999, 2));
}

TEST(Frechet, sees_a_corner_cut_short_and_a_spike_added) {
  const Polyline corner{{0, 0}, {10, 0}, {10, 10}}, cut{{0, 0}, {9, 0}, {10, 1}, {10, 10}};
  EXPECT_TRUE(frechet_within(cut, corner, 0.7072, 2));
  EXPECT_FALSE(frechet_within(cut, corner, 0.7070, 2));
  const Polyline spike{{0, 0}, {5, 0}, {5, 0.3}, {5, 0}, {10, 0}};
  EXPECT_FALSE(frechet_within(spike, kStraight, 0.29, 2));
  EXPECT_TRUE(frechet_within(spike, kStraight, 0.31, 2));
}

TEST(Frechet, sees_a_path_that_does_not_end_where_it_should) {
  EXPECT_FALSE(frechet_within({{0, 0}, {9, 0}}, kStraight, 0.5, 2));
}

TEST(ProgrammedPath, follows_an_arc_closely) {
  const Polyline p = programmed_path({}, {arc_to(10, 10, 10, 0, -90, 50)}, 3, 1e-4);
  ASSERT_GT(p.size(), 50u);
  for (const Vector& v : p) EXPECT_NEAR(std::hypot(v[0] - 10, v[1]), 10, 1e-9);
}

}  // namespace
}  // namespace servogate::path::test
