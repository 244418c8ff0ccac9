// SPDX-License-Identifier: Apache-2.0
// Rigid taps: legs on one line, a spindle that turns round between them, and what becomes of a tap whose
// spindle does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/path/rig/lathe.hpp"

namespace servogate::path::test {
namespace {

constexpr double kLead = 1.25;

/// A tap that goes along Z from one of `places` to the next and ends at 0: the spindle obeys what the
/// follower asks for, but for what a test takes from it.
struct Tapping : Lathe {
  explicit Tapping(const std::vector<double>& places, double lead_mm = kLead, double dwell = 0.0,
                   const Config& c = lathe())
      : Lathe(c), lead_of(lead_mm) {
    std::int8_t turn = -1;
    for (const double z : places) {
      Element leg = thread_to(0, z, lead_mm);
      leg.lock.kind = Lock::Kind::tap_in;
      leg.lock.turn = turn;
      leg.lock.dwell = dwell;
      leg.transition.continuation = Continuation::exact_stop;
      add(leg);
      turn = static_cast<std::int8_t>(-turn);
    }
    Element out = thread_to(0, 0.0, lead_mm);
    out.lock.kind = Lock::Kind::tap_out;
    out.transition.continuation = Continuation::exact_stop;
    add(out);
    planner.finish();
  }
  const Sample& turn() {
    const Sample& s = step();
    if (s.master.halt && stops)
      spindle.wanted = 0.0;
    else if (s.master.turn != 0 && turns_round)
      spindle.wanted = 10.0 * s.master.turn;
    deepest = std::min(deepest, s.position[2]);
    const double off = -s.position[2] - lead_of * spindle.n;
    if (s.master.locked && locked_cycles++ == 0) at_lock = off;
    if (locked_cycles > 0 && s.master.bound) parted = std::max(parted, std::abs(off - at_lock));
    return s;
  }
  bool turn_until(const std::function<bool(const Sample&)>& met, int cycles = 60000) {
    for (; cycles > 0; --cycles)
      if (met(turn())) return true;
    return false;
  }
  bool rests() {
    return turn_until(
        [](const Sample& s) { return s.state == FollowerState::stopped || s.state == FollowerState::idle; });
  }
  const Sample& last() const { return trip.samples.back(); }

  bool stops = true, turns_round = true;  ///< what the spindle does
  double lead_of, deepest = 0.0, at_lock = 0.0, parted = 0.0;
  int locked_cycles = 0;
};

TEST(Tap, goes_with_its_spindle_to_the_depth_and_back_and_says_how_far_it_went_beyond) {
  for (const double dead : {0.001, 0.020}) {
    Tapping m({-20.0});
    m.spindle.dead_s = dead;
    double deepest = 0.0, worst = 0.0, at_lock = 1e9;
    int locked = 0, asked = 0;  // the order is as long under way as a reading
    ASSERT_TRUE(m.until([&](const Sample& s) {
      if (s.master.turn < 0 && ++asked > dead / 0.001) m.spindle.wanted = -10.0;
      deepest = std::min(deepest, s.position[2]);
      if (s.master.locked && locked++ == 0) at_lock = -s.position[2] - 1.25 * m.spindle.n;
      if (s.master.locked) worst = std::max(worst, std::abs(-s.position[2] - 1.25 * m.spindle.n - at_lock));
      return s.state == FollowerState::idle;
    }));
    const double overshoot = m.trip.samples.back().master.overshoot;
    const double bound = phase_bound(m.spindle.quality(), 1.25);
    std::printf("tap: deepest %.4f mm, overshoot said %.4f mm, off its spindle %.4f mm, bound %.4f\n",
                -deepest, overshoot, worst, bound);
    EXPECT_NEAR(-deepest - 20.0, overshoot, 1e-6);
    EXPECT_LE(std::abs(deepest + 20.0), 1.25) << "within a revolution of its depth";
    EXPECT_LE(worst, 2.0 * bound);
    EXPECT_EQ(m.trip.samples.back().position, Vector{});
    EXPECT_LE(m.limits(), 1.001);
  }
}

TEST(Tap, that_is_stopped_stays_with_its_spindle_until_that_stands) {
  for (const double z : {-2.0, -10.0, -19.0}) {
    for (const bool out : {false, true}) {
      Tapping m({-20.0});
      ASSERT_TRUE(m.turn_until([&](const Sample& s) {
        return s.master.locked && (out ? m.spindle.w < -5.0 && s.position[2] > z : s.position[2] < z);
      }));
      m.follower.stop();
      ASSERT_TRUE(m.rests()) << z << out;
      EXPECT_LT(std::abs(m.spindle.w), 0.3) << "the axis has not stopped before its spindle";
      EXPECT_LE(m.parted, 2.0 * phase_bound(m.spindle.quality(), kLead)) << z << out;
      EXPECT_EQ(m.last().position[0], 0.0) << "a tap is not pulled aside";
      EXPECT_LE(m.limits(), 1.001) << z << out;
    }
  }
}

TEST(Tap, whose_spindle_does_not_obey_stops_within_the_overshoot_that_is_allowed) {
  for (const bool stopped : {false, true}) {
    Config config = lathe();
    config.threads.tap_overshoot = 2.0;
    Tapping m({-20.0}, kLead, 0.0, config);
    m.stops = m.turns_round = false;
    ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.position[2] < -10.0; }));
    if (stopped) m.follower.stop();
    ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.state == FollowerState::stopped; })) << stopped;
    EXPECT_LE(-m.deepest, 20.0 + 2.0 + 1e-6) << stopped;
    EXPECT_GT(-m.deepest, 20.0) << "until then it goes with its spindle";
    const auto told = std::find_if(m.trip.samples.begin(), m.trip.samples.end(),
                                   [](const Sample& s) { return s.master.fault != MasterFault::none; });
    ASSERT_NE(told, m.trip.samples.end());
    EXPECT_EQ(told->master.fault, MasterFault::overshoot);
    EXPECT_TRUE(told->master.halt) << "the spindle is to stop, too";
    EXPECT_GT(told->master.value, told->master.limit);
    EXPECT_LE(m.limits(), 1.001);
  }
}

TEST(Tap, whose_spindle_stands_at_the_depth_and_does_not_turn_round_is_given_up) {
  Tapping m({-20.0});
  m.turns_round = false;
  const auto fault = [](const Sample& s) { return s.master.fault != MasterFault::none; };
  ASSERT_TRUE(m.turn_until([&](const Sample& s) {
    if (s.master.turn < 0) m.spindle.wanted = 0.0;
    return fault(s);
  }));
  EXPECT_EQ(m.last().master.fault, MasterFault::no_turn);
  EXPECT_NEAR(m.last().position[2], -20.0, kLead);
  ASSERT_TRUE(m.rests());
  EXPECT_EQ(m.last().state, FollowerState::stopped);
}

TEST(Tap, whose_spindle_stands_on_the_way_out_is_given_up) {
  Tapping m({-20.0});
  ASSERT_TRUE(m.turn_until([&](const Sample& s) { return m.spindle.w < -5.0 && s.position[2] > -10.0; }));
  m.turns_round = false;
  m.spindle.wanted = 0.0;
  ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.master.fault != MasterFault::none; }));
  EXPECT_EQ(m.last().master.fault, MasterFault::no_turn);
  ASSERT_TRUE(m.rests());
  EXPECT_LT(m.last().position[2], -5.0) << "still in its hole";
}

TEST(Tap, whose_spindle_stands_on_the_way_in_waits_with_it_and_goes_on_with_it) {
  Tapping m({-20.0});
  ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.master.locked && s.position[2] < -8.0; }));
  m.spindle.wanted = 0.0;
  for (int n = 0; n < 1500; ++n) m.turn();
  EXPECT_EQ(m.last().master.fault, MasterFault::none);
  EXPECT_LT(std::abs(m.spindle.w), 0.01);
  m.spindle.wanted = 10.0;
  ASSERT_TRUE(m.rests()) << m.why();
  EXPECT_EQ(m.last().state, FollowerState::idle);
  EXPECT_NEAR(-m.deepest, 20.0, 0.5);
  EXPECT_LE(m.parted, 2.0 * phase_bound(m.spindle.quality(), kLead));
}

TEST(Tap, whose_spindle_turns_back_unasked_is_given_up) {
  Tapping m({-20.0});
  ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.master.locked && s.position[2] < -8.0; }));
  m.spindle.wanted = -10.0;
  ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.master.fault != MasterFault::none; }, 3000));
  EXPECT_EQ(m.last().master.fault, MasterFault::reversed);
}

TEST(Tap, dwells_at_its_depth_with_the_spindle_standing_and_goes_back_by_the_same_angle) {
  Tapping m({-12.0}, kLead, 0.4);
  int stands = 0;
  ASSERT_TRUE(m.turn_until([&](const Sample& s) {
    if (std::abs(m.spindle.w) < kMasterStands && s.position[2] < -11.0) ++stands;
    return s.state == FollowerState::idle;
  })) << m.why();
  EXPECT_GE(stands, 300) << "cycles; the estimate of the speed is some cycles behind";
  EXPECT_LE(stands, 600);
  EXPECT_NEAR(-m.deepest, 12.0, 0.3);
  EXPECT_EQ(m.last().position, Vector{});
  EXPECT_LE(m.parted, 2.0 * phase_bound(m.spindle.quality(), kLead));
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Tap, breaks_its_chips_by_ways_back_of_any_length_and_never_leaves_its_spindle) {
  Tapping m({-6.0, -4.5, -12.0, -10.5, -18.0});
  std::vector<double> turning_points;
  double before = 0.0, moved = 0.0;
  ASSERT_TRUE(m.turn_until([&](const Sample& s) {
    const double step = s.position[2] - before;
    if (step * moved < 0.0 && s.master.locked) turning_points.push_back(before);
    if (step != 0.0) moved = step;
    before = s.position[2];
    return s.state == FollowerState::idle;
  })) << m.why();
  ASSERT_EQ(turning_points.size(), 5u);
  const double places[] = {-6.0, -4.5, -12.0, -10.5, -18.0};
  for (std::size_t n = 0; n < 5; ++n) EXPECT_NEAR(turning_points[n], places[n], 0.3) << n;
  EXPECT_NEAR(m.last().master.overshoot, -m.deepest - 18.0, 1e-6);
  EXPECT_EQ(m.last().position, Vector{});
  EXPECT_LE(m.parted, 2.0 * phase_bound(m.spindle.quality(), kLead));
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Tap, whose_angle_is_lost_slows_down_as_its_spindle_is_told_to) {
  Tapping m({-20.0});
  ASSERT_TRUE(m.turn_until([](const Sample& s) { return s.master.locked && s.position[2] < -10.0; }));
  m.spindle.readable = false;
  ASSERT_TRUE(m.rests());
  const Box axis{m.config.limits[2].velocity, m.config.limits[2].acceleration, m.config.limits[2].jerk};
  const double own_stop = ramp_distance(10.0 * kLead, 0.0, 0.0, axis);
  const double spindle_way = 0.5 * 10.0 * 10.0 / m.spindle.motor * kLead;
  std::printf("lost: parted by %.3f mm; by its own limits it would be %.3f mm\n", m.parted,
              spindle_way - own_stop);
  EXPECT_LT(m.parted, 0.4 * (spindle_way - own_stop)) << "of readings that are 25 ms late to be missed";
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Tap, whose_master_is_lost_slows_down_on_its_line_in_each_phase) {
  for (const double z : {-0.05, -10.0, -19.5}) {
    for (const bool out : {false, true}) {
      Tapping m({-20.0});
      bool turned = false;
      ASSERT_TRUE(m.until([&](const Sample& s) {
        if (s.master.turn < 0) m.spindle.wanted = -10.0;
        turned = turned || m.spindle.w < -5.0;
        return out ? turned && s.position[2] > z : s.position[2] < z;
      })) << z
          << out;
      m.spindle.readable = false;
      ASSERT_TRUE(m.until([](const Sample& s) {
        return s.state == FollowerState::stopped || s.state == FollowerState::idle;
      })) << z
          << out;
      EXPECT_EQ(m.trip.samples.back().position[0], 0.0) << "a tap is not pulled aside";
      EXPECT_LE(m.limits(), 1.001) << z << out;
    }
  }
}

}  // namespace
}  // namespace servogate::path::test
