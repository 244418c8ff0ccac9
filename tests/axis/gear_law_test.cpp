// SPDX-License-Identifier: Apache-2.0
// The set-point of an axis that is led to a moving place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kernel/axis/coupling/gear_law.hpp"
#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

constexpr double kDt = 0.001;
constexpr MotionLimits kLimits{200.0, 1000.0, 10000.0};

/// A master that is driven by a ramp, and a follower of it.
class Pair {
 public:
  explicit Pair(const MotionLimits& of_master, double x = 0.0) : of_master_(of_master) {
    master.reset({}, of_master);
    state.x = x;
  }
  void cycle(bool exact, bool placed = true) {
    GearTarget target;
    target.now = master.state();
    target.next = master.step(kDt);
    target.exact = exact;
    target.placed = placed;
    state = law.step(state, target, kLimits, kDt);
  }
  double off() const { return state.x - master.state().x; }
  bool until_near(double most, bool exact, int patience = 20000) {
    while (patience-- > 0) {
      cycle(exact);
      if (std::abs(off()) <= most) return true;
    }
    return false;
  }

  Ramp master;
  GearLaw law;
  MotionState state;
  MotionLimits of_master_;
};

TEST(GearLaw, never_leaves_its_limits_whatever_its_master_does) {
  std::mt19937 random(test::fresh_seed());
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int run = 0; run < 60; ++run) {
    const MotionLimits mine{real(20.0, 400.0), real(100.0, 3000.0), real(1000.0, 50000.0)};
    const MotionLimits masters{mine.velocity * real(0.1, 1.5), mine.acceleration * real(0.1, 4.0),
                               mine.jerk * real(0.1, 10.0)};
    const double noise = run % 3 == 0 ? real(0.0, 0.05) : 0.0;
    const bool exact = run % 2 == 0 && noise == 0.0;
    Ramp master;
    master.reset({}, masters);
    GearLaw law;
    MotionState state{real(-50.0, 50.0), 0.0, 0.0};
    test::Judge judge(state.x, kDt);
    for (int n = 0; n < 6000; ++n) {
      if (n % 500 == 0) {
        if (real(0.0, 1.0) < 0.7)
          master.move_at(real(-1.0, 1.0) * masters.velocity, masters);
        else
          master.move_to(master.state().x + real(-50.0, 50.0), masters);
      }
      GearTarget target;
      target.now = master.state();
      target.next = master.step(kDt);
      target.now.x += real(-noise, noise);
      target.now.v += 20.0 * real(-noise, noise);
      target.now.a += 400.0 * real(-noise, noise);
      target.exact = exact;
      target.placed = n > 300;
      state = law.step(state, target, mine, kDt);
      judge.add(state.x);
    }
    ASSERT_TRUE(judge.within(mine)) << "run " << run << " noise " << noise << " exact " << exact;
  }
}

TEST(GearLaw, catches_a_master_that_turns_steadily_and_stays_with_it) {
  for (const bool exact : {false, true})
    for (const double speed : {-150.0, 3.0, 120.0, 190.0})
      for (const double from : {-30.0, 0.0, 5.0}) {
        Pair p(kLimits, from);
        p.master.reset({0.0, speed, 0.0}, kLimits);
        p.master.move_at(speed, kLimits);
        ASSERT_TRUE(p.until_near(1e-6, exact)) << speed << " from " << from;
        for (int n = 0; n < 500; ++n) {
          p.cycle(exact);
          ASSERT_LE(std::abs(p.off()), 0.01) << speed << " from " << from;
        }
        EXPECT_LE(std::abs(p.off()), 1e-6);
        EXPECT_NEAR(p.state.v, speed, 1e-5);
      }
}

TEST(GearLaw, goes_to_a_place_at_rest_about_as_quickly_as_its_limits_permit) {
  for (const double way : {0.5, 20.0, 100.0}) {
    Ramp best;
    best.reset({}, kLimits);
    best.move_to(way, kLimits);
    Pair p(kLimits, -way);
    int cycles = 0;
    while (std::abs(p.off()) > 0.001 && cycles < 20000) {
      p.cycle(true);
      ++cycles;
    }
    EXPECT_LE(cycles * kDt, best.time_left() * 1.1 + 0.1) << way;
  }
}

TEST(GearLaw, takes_the_set_points_of_its_master_as_they_are_where_its_limits_permit) {
  Pair p(kLimits);
  const MotionLimits slower{150.0, 900.0, 9000.0};
  double worst = 0.0;
  for (int n = 0; n < 8000; ++n) {
    if (n % 1000 == 0) p.master.move_to(n % 2000 == 0 ? 70.0 : -20.0, slower);
    p.cycle(true);
    worst = std::max(worst, std::abs(p.off()));
  }
  EXPECT_EQ(worst, 0.0);
}

TEST(GearLaw, lags_a_master_that_is_quicker_than_its_limits_and_catches_up) {
  Pair p(kLimits);
  const MotionLimits quicker{150.0, 4000.0, 100000.0};
  double worst = 0.0;
  p.master.move_at(150.0, quicker);
  for (int n = 0; n < 1000; ++n) {
    p.cycle(true);
    worst = std::max(worst, std::abs(p.off()));
  }
  EXPECT_GT(worst, 1.0) << "the test means nothing otherwise";
  EXPECT_LE(std::abs(p.off()), 1e-6);
}

TEST(GearLaw, takes_the_speed_alone_until_its_place_is_chosen) {
  Pair p(kLimits, 17.0);
  p.master.reset({0.0, 100.0, 0.0}, kLimits);
  p.master.move_at(100.0, kLimits);
  for (int n = 0; n < 1000; ++n) p.cycle(false, false);
  EXPECT_NEAR(p.state.v, 100.0, 1e-6);
  EXPECT_LT(p.off(), 17.0) << "what it lost while it ramped is not caught up";
}

}  // namespace
}  // namespace servogate::axis
