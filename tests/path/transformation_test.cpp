// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/axes/transformation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/path/rig/trip.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

/// Path coordinates turned in the plane of the first two axes, and shifted.
class Turned final : public Transformation {
 public:
  explicit Turned(double angle) : c_(std::cos(angle)), s_(std::sin(angle)) {}
  void to_axes(PathPoint& at, int axes) const noexcept override {
    if (axes < 2) return;
    for (Vector* v : {&at.x, &at.d1, &at.d2, &at.d3}) {
      const double x = (*v)[0], y = (*v)[1];
      (*v)[0] = c_ * x - s_ * y;
      (*v)[1] = s_ * x + c_ * y;
    }
    at.x[0] += 20.0;
  }
  Vector back(Vector at, int axes) const {
    if (axes < 2) return at;
    const double x = at[0] - 20.0, y = at[1];
    at[0] = c_ * x + s_ * y;
    at[1] = c_ * y - s_ * x;
    return at;
  }

 private:
  double c_, s_;
};

TEST(Transformation, the_axes_keep_their_limits_and_the_path_its_tolerance_in_a_turned_frame) {
  const std::uint64_t base = servogate::test::property_seed();
  for (std::uint64_t seed = base; seed < base + 60; ++seed) {
    RandomProgram p = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    const Turned turned(0.1 + 0.01 * static_cast<double>(seed % 600));
    p.config.transformation = &turned;
    Scenario scenario{seed};
    scenario.overrides = seed % 2 == 0;
    scenario.holds = seed % 3 == 0;
    scenario.disturbed = 500;
    Trip trip = run(p, scenario);
    const Worst on_axes = worst(trip, p.config);
    ASSERT_LE(on_axes.most(), 1.001) << "seed " << seed;
    for (Sample& s : trip.samples) s.position = turned.back(s.position, p.config.axis_count);
    p.config.limits.fill({1e9, 1e9, 1e12});
    ASSERT_EQ(verdict(trip, p), "") << "seed " << seed;
  }
}

TEST(Transformation, the_derivatives_given_out_are_those_of_the_axes) {
  const Turned turned(0.7);
  RandomProgram p;
  p.config = mill();
  p.config.transformation = &turned;
  const Element arc = arc_to(40, 0, 20, 0, -180, 100), line = line_to(60, 30, 0, 100);
  for (const bool course : {true, false}) {
    p.elements = {arc, line};
    if (!course) {
      p.elements[0].feed = 20;  // so that it needs little of its axes
      p.elements[0].transition.continuation = Continuation::exact_stop;
    }
    const Trip trip = run(p, {});
    const double t = p.config.period_s;
    for (std::size_t k = 2; k + 1 < trip.samples.size(); ++k) {
      const Sample &a = trip.samples[k - 1], &b = trip.samples[k], &c = trip.samples[k + 1];
      for (int i = 0; i < 3; ++i) {
        ASSERT_NEAR((c.position[i] - a.position[i]) / (2 * t), b.velocity[i], 0.01);
        ASSERT_NEAR((c.velocity[i] - a.velocity[i]) / (2 * t), b.acceleration[i], 10.0);
      }
    }
  }
}

TEST(Transformation, a_course_takes_the_time_that_it_takes_on_axes_that_are_not_turned) {
  const Turned turned(0.5 * std::numbers::pi);
  std::vector<Element> blocks;
  for (int k = 1; k <= 600; ++k) blocks.push_back(line_to(0.3 * k, 3 * std::sin(k * 0.05), 0, 100));
  Config config = mill();
  config.limits[1] = {200, 400, 5000};  // turned by a right angle the other axis is the slow one
  const double straight = estimate(config, {}, blocks).seconds;
  std::swap(config.limits[0], config.limits[1]);
  config.transformation = &turned;
  EXPECT_NEAR(estimate(config, {}, blocks).seconds, straight, 0.01 * straight);
}

}  // namespace
}  // namespace servogate::path::test
