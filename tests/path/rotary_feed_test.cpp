// SPDX-License-Identifier: Apache-2.0
// The feed is the speed of the vector over millimetres and degrees, whatever the share of the linear axes is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/path/rig/trip.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kFeed = 50.0;

/// X, Y, Z and a rotary axis that could turn at ten times the feed.
RandomProgram turning(int blocks, double degrees, const std::function<double(int)>& z) {
  RandomProgram p;
  p.config = mill();
  p.config.axis_count = 4;
  p.config.rotary[3] = true;
  p.config.limits[3] = {10 * kFeed, 5000.0, 50000.0};
  p.tolerance = 0.01;
  for (int n = 1; n <= blocks; ++n) {
    Element e = line_to(0, 0, z(n), kFeed);
    e.to[3] = degrees * n;
    e.tag.line = n;
    p.elements.push_back(e);
  }
  p.elements.back().transition.continuation = Continuation::exact_stop;
  return p;
}

double fastest(const Trip& trip) {
  double most = 0.0;
  for (std::size_t n = 1; n < trip.samples.size(); ++n) {
    double square = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      square += std::pow(trip.samples[n].position[i] - trip.samples[n - 1].position[i], 2);
    most = std::max(most, std::sqrt(square) * 1000.0);
  }
  return most;
}

double seconds(const Trip& trip) { return 0.001 * static_cast<double>(trip.samples.size()); }

TEST(RotaryFeed, is_kept_where_the_linear_axes_move_less_than_the_tolerance) {
  const std::uint64_t seed = servogate::test::property_seed();
  const RandomProgram plain = turning(300, 0.5, [](int) { return 0.0; });
  const double usual = seconds(run(plain, {}));
  EXPECT_NEAR(usual, 3.0, 0.2);
  for (std::uint64_t k = 0; k < 16; ++k) {
    std::mt19937_64 random(seed + k);
    const double size = std::pow(10.0, -9.0 + 6.7 * std::uniform_real_distribution(0.0, 1.0)(random));
    const RandomProgram p =
        turning(300, 0.5, [&](int) { return size * std::uniform_real_distribution(-1.0, 1.0)(random); });
    const Trip trip = run(p, {});
    EXPECT_EQ(verdict(trip, p), "") << seed + k;
    EXPECT_LE(fastest(trip), 1.002 * kFeed) << seed + k << ", " << size << " mm";
    EXPECT_LE(seconds(trip), 1.1 * usual) << seed + k << ", " << size << " mm";
  }
}

TEST(RotaryFeed, is_that_of_the_vector_in_moves_of_both_kinds) {
  for (const double mm : {0.001, 0.1, 10.0, 30.0}) {
    RandomProgram p = turning(1, 30.0, [&](int) { return mm; });
    const Trip trip = run(p, {});
    EXPECT_NEAR(fastest(trip), kFeed, 0.01 * kFeed) << mm;
    EXPECT_NEAR(seconds(trip), std::hypot(30.0, mm) / kFeed, 0.25) << mm;
  }
}

TEST(RotaryFeed, goes_on_where_long_moves_differ_in_a_micrometre_of_a_linear_axis) {
  const RandomProgram plain = turning(3, 30.0, [](int) { return 0.0; });
  const RandomProgram p = turning(3, 30.0, [](int n) { return n >= 2 ? 0.001 : 0.0; });
  const Trip trip = run(p, {});
  EXPECT_EQ(verdict(trip, p), "");
  EXPECT_NEAR(seconds(trip), seconds(run(plain, {})), 0.05);
}

}  // namespace
}  // namespace servogate::path::test
