// SPDX-License-Identifier: Apache-2.0
// Threads: the path goes with the measured angle of the spindle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/path/rig/lathe.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

TEST(Thread, of_1_5_mm_at_600_rpm_and_4096_counts_is_within_10_um_of_the_true_angle) {
  Lathe m;
  m.lead = 1.5;
  m.add(thread_to(0, -60, 1.5));
  ASSERT_TRUE(m.finish());
  EXPECT_NEAR(m.trip.samples.back().position[2], -60.0, 1e-9);
  const double bound = phase_bound(m.spindle.quality(), 1.5);
  std::printf("pitch error at constant speed: %.3f um, bound %.3f um, %d cycles locked\n", m.worst_mm * 1e3,
              bound * 1e3, m.locked);
  EXPECT_GT(m.locked, 2000);
  EXPECT_LE(m.worst_mm, 0.010);
  EXPECT_LE(m.worst_mm, bound);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, lies_at_the_same_angle_at_each_speed_and_each_start_where_it_is_programmed) {
  for (const double rpm : {150.0, 600.0, 1200.0})
    for (const double start : {0.0, 1.0 / 3.0, 0.75}) {
      Lathe m;
      m.lead = 2.0;
      m.start = start;
      m.spindle.wanted = m.spindle.w = rpm / 60.0;
      m.spindle.n = 0.1 + 0.2 * start;
      m.add(thread_to(0, -60, 2.0, rpm, start));
      ASSERT_TRUE(m.finish());
      EXPECT_LE(m.worst_mm, 0.010) << rpm << " rpm, start " << start;
      EXPECT_GT(m.locked, 500);
    }
}

TEST(Thread, is_cut_with_the_spindle_turning_the_other_way) {
  Lathe m;
  m.lead = 1.0;
  m.sign = -1.0;
  m.spindle.w = -10.0;
  m.add(thread_to(0, 40, 1.0));
  const auto step = [&] {
    m.planner.work();
    m.follower.set_spindle(10.0);
  };
  step();
  m.spindle.wanted = -10.0;
  m.planner.finish();
  for (int n = 0; n < 8000 && m.locked < 2000; ++n) {
    m.planner.work();
    m.follower.set_spindle(10.0);
    m.follower.set_master(m.spindle.reading());
    m.trip.samples.push_back(m.follower.step(m.track.visible()));
    m.spindle.step();
    const Sample& s = m.trip.samples.back();
    if (!s.master.locked) continue;
    const double off = s.position[2] - -m.spindle.n;
    m.worst_mm = std::max(m.worst_mm, std::abs(off - std::round(off)));
    ++m.locked;
  }
  EXPECT_GT(m.locked, 1000);
  EXPECT_LE(m.worst_mm, 0.010);
}

TEST(Thread, with_a_taper_keeps_the_lead_along_its_longest_axis_and_moves_both_axes) {
  Lathe m;
  m.lead = 1.5;
  Element e = thread_to(3, -50, 1.5);
  const double length = std::hypot(3.0, 50.0);
  e.lock.per_turn = 1.5 * length / 50.0;
  e.feed = e.lock.per_turn * e.revolutions;
  m.add(e);
  ASSERT_TRUE(m.finish());
  EXPECT_LE(m.worst_mm, 0.010);
  EXPECT_NEAR(m.trip.samples.back().position[0], 3.0, 1e-9);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_goes_on_without_a_rest_and_without_losing_its_angle) {
  Lathe m;
  m.lead = 1.5;
  m.add(thread_to(0, -30, 1.5));
  Element cone = thread_to(1.5, -60, 1.5);
  cone.lock.per_turn = 1.5 * std::hypot(1.5, 30.0) / 30.0;
  m.add(cone);
  m.add(thread_to(1.5, -90, 1.5));
  m.planner.finish();
  double slowest = 1e9;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    if (s.master.locked) slowest = std::min(slowest, s.feed);
    return s.state == FollowerState::idle;
  }));
  EXPECT_NEAR(m.trip.samples.back().position[2], -90.0, 1e-9);
  EXPECT_GT(slowest, 14.0) << "no rest between the parts";
  EXPECT_LE(m.worst_mm, 0.020) << "the corners are rounded within 0.02 mm";
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_says_in_the_middle_of_its_corner_that_the_next_part_is_in_motion_and_its_mark_is_passed) {
  Lathe m;
  m.lead = 1.5;
  Element straight = thread_to(0, -30, 1.5), cone = thread_to(3, -60, 1.5);
  cone.lock.per_turn = 1.5 * std::hypot(3.0, 30.0) / 30.0;
  straight.tag.line = 1;
  cone.tag.line = 2;
  m.add(straight);
  m.planner.add_mark();
  m.add(cone);
  m.planner.finish();
  double line_at = 0.0, passed_at = 0.0;
  std::uint32_t passed = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    passed += s.passed;
    if (s.passed > 0) passed_at = s.position[2];
    if (s.tag.line == 2 && line_at == 0.0) line_at = s.position[2];
    return s.state == FollowerState::idle;
  }));
  EXPECT_EQ(passed, 1u);
  EXPECT_NEAR(passed_at, -30.0, 0.03) << "two cycles";
  EXPECT_NEAR(line_at, -30.0, 0.03);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_of_short_lines_along_a_curve_is_smoothed_inside_of_its_tolerance_and_keeps_its_speed) {
  constexpr double kRadius = 50.0, kStep = 0.002;  // lines of 0.1 mm
  Lathe m;
  m.spindle.wanted = m.spindle.w = 12.0;
  std::vector<Element> lines;
  for (int n = 1; n <= 600; ++n) {
    const double a = kStep * n;
    lines.push_back(thread_to(kRadius * (1.0 - std::cos(a)), -kRadius * std::sin(a), 2.0, 720.0));
    m.add(lines.back());
  }
  ASSERT_TRUE(m.finish()) << m.why();
  EXPECT_EQ(m.why(), "no fault");
  Polyline driven;
  double fastest = 0.0;
  for (const Sample& s : m.trip.samples) {
    driven.push_back(s.position);
    fastest = std::max(fastest, s.feed);
  }
  EXPECT_NEAR(fastest, 24.0, 1.0) << "corner by corner the axes allow 18 mm/s";
  EXPECT_TRUE(frechet_within(driven, programmed_path({}, lines, 3), 0.0201, 3));
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_that_leads_back_rests_there_and_finds_its_angle_again) {
  Lathe m;
  m.lead = 1.5;
  m.add(thread_to(0, -30, 1.5));
  m.add(thread_to(0, -1, 1.5));
  m.planner.finish();
  bool rested = false;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    rested = rested || (s.feed == 0.0 && std::abs(s.position[2] + 30.0) < 1e-9);
    return s.state == FollowerState::idle;
  }));
  EXPECT_TRUE(rested);
  EXPECT_NEAR(m.trip.samples.back().position[2], -1.0, 1e-9);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_of_two_leads_settles_on_the_second_one_inside_of_the_limits) {
  Lathe m;
  m.add(thread_to(0, -30, 1.0));
  m.add(thread_to(0, -90, 2.0));
  m.planner.finish();
  m.lead = 0.0;
  double worst_behind = 0.0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    if (s.master.locked && s.position[2] < -45.0 && s.position[2] > -85.0) {
      const double off = (-s.position[2] - 30.0) / 2.0 + 30.0 - m.spindle.n;
      worst_behind = std::max(worst_behind, 2.0 * std::abs(off - std::round(off)));
    }
    return s.state == FollowerState::idle;
  }));
  EXPECT_GT(worst_behind, 0.0);
  EXPECT_LE(worst_behind, 0.010);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, of_a_changing_lead_follows_its_law) {
  Lathe m;
  Element e = thread_to(0, -70, 1.0);
  e.lock.change = 0.1;
  m.add(e);
  m.planner.finish();
  double worst = 0.0;
  int locked = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    if (s.master.locked && s.position[2] > -65.0) {
      const double z = -s.position[2], turns = (std::sqrt(1.0 + 2.0 * 0.1 * z) - 1.0) / 0.1;
      const double off = turns - m.spindle.n;
      worst = std::max(worst, (1.0 + 0.1 * turns) * std::abs(off - std::round(off)));
      ++locked;
    }
    return s.state == FollowerState::idle;
  }));
  EXPECT_GT(locked, 500);
  EXPECT_LE(worst, 0.010);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, behind_a_jittering_spindle_stays_within_the_bound_and_never_breaks_a_limit) {
  const std::uint64_t first = servogate::test::property_seed();
  double closest = 0.0;
  for (std::uint64_t seed = first; seed < first + 60; ++seed) {
    std::mt19937_64 random(seed);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    Config config = lathe();
    config.threads.window = 1e9;  // what the bound says is looked at
    Lathe m(config);
    TurningSpindle& s = m.spindle;
    s.random.seed(seed);
    const double rpm = between(100.0, 900.0);
    s.wanted = s.w = rpm / 60.0;
    s.n = between(0.0, 1.0);
    s.counts = std::uniform_int_distribution<>(0, 1)(random) ? 4096.0 : 1024.0;
    s.noise = between(0.0, 1.0);
    s.dead_s = std::uniform_int_distribution<>(0, 1)(random) ? 0.001 : 0.001 * std::floor(between(1.0, 51.0));
    s.motor = 20.0;
    const double dip = between(0.0, 6.0), every = between(0.2, 0.8), lasts = between(0.05, 0.15);
    s.load = [=](double t) { return std::fmod(t, every) < lasts ? dip : 0.0; };
    m.lead = between(0.3, 2.0);
    m.add(thread_to(0, -40, m.lead, rpm));
    ASSERT_TRUE(m.finish()) << "seed " << seed << " " << m.why();
    const double bound = phase_bound(s.quality(), m.lead);
    EXPECT_LE(m.worst_mm, bound) << "seed " << seed;
    EXPECT_LE(m.limits(), 1.001) << "seed " << seed;
    EXPECT_GT(m.locked, 100) << "seed " << seed;
    closest = std::max(closest, m.worst_mm / bound);
  }
  std::printf("largest share of the bound: %.3f\n", closest);
}

TEST(Thread, behind_a_wild_spindle_never_breaks_a_limit) {
  const std::uint64_t first = servogate::test::property_seed();
  for (std::uint64_t seed = first; seed < first + 60; ++seed) {
    std::mt19937_64 random(seed);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    Config config = lathe();
    config.threads.window = between(0.05, 5.0);
    config.threads.hold_retracts = seed % 2 == 0;
    Lathe m(config);
    const double rpm = between(100.0, 3000.0), lead = between(0.3, 6.0);
    m.spindle.wanted = m.spindle.w = rpm / 60.0;
    m.spindle.motor = 1000.0;
    m.spindle.counts = 256.0;
    m.spindle.noise = between(0.0, 4.0);
    const double push = between(0.0, 800.0), every = between(0.02, 0.5);
    m.spindle.load = [=](double t) { return std::fmod(t, every) < 0.5 * every ? push : -push; };
    Element e = thread_to(between(-5.0, 5.0), -80, lead, rpm);
    e.lock.change = between(-0.002, 0.05);
    m.add(e);
    m.add(thread_to(e.to[0] + between(-3.0, 3.0), -150, between(0.3, 6.0), rpm));
    m.planner.finish();
    const int held = static_cast<int>(between(500.0, 5000.0));
    for (int n = 0; n < 200000; ++n) {
      const FollowerState state = m.trip.samples.back().state;
      if (n > held + 300 && (state == FollowerState::idle || state == FollowerState::stopped)) break;
      if (n == held) m.follower.hold();
      if (n == held + 300) m.follower.resume();
      m.step();
    }
    EXPECT_LE(m.limits(), 1.001) << "seed " << seed;
  }
}

TEST(Thread, that_is_held_ends_its_pass_at_its_end_and_is_held_there) {
  Lathe m;
  m.lead = 1.5;
  m.add(thread_to(0, -60, 1.5));
  m.add(line_to(5, 0, -60, 50));
  m.into_thread();
  m.follower.hold();
  EXPECT_EQ(m.step().state, FollowerState::holding);
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::held; }));
  EXPECT_NEAR(m.trip.samples.back().position[2], -60.0, 1e-9);
  EXPECT_LE(m.worst_mm, 0.010);
  m.follower.resume();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::idle; }));
  EXPECT_NEAR(m.trip.samples.back().position[0], 5.0, 1e-9);
}

TEST(Thread, that_is_held_leaves_the_part_where_that_is_declared) {
  Config config = lathe();
  config.threads.hold_retracts = true;
  Lathe m(config);
  m.add(thread_to(0, -60, 1.5));
  m.into_thread();
  m.follower.hold();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
  EXPECT_NEAR(m.trip.samples.back().position[0], 2.0, 1e-9);
  EXPECT_GT(m.trip.samples.back().position[2], -25.0) << "and not to the end of the pass";
  EXPECT_LE(m.limits(), 1.001);
}

/// What a fault of the master does in each phase of a thread.
void expect_left(MasterFault fault, const std::function<void(Lathe&)>& break_it, double window = 0.2) {
  for (const double z : {-3.0, -10.0, -30.0}) {
    Config config = lathe();
    config.threads.window = window;
    Lathe m(config);
    m.add(thread_to(0, -60, 1.5));
    m.into_thread(z);
    break_it(m);
    ASSERT_TRUE(m.until([](const Sample& s) { return s.master.fault != MasterFault::none; }, 8000)) << z;
    EXPECT_EQ(m.trip.samples.back().master.fault, fault) << z;
    ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }, 8000)) << z;
    EXPECT_NEAR(m.trip.samples.back().position[0], 2.0, 1e-9) << z;
    EXPECT_LE(m.limits(), 1.001) << z;
  }
}

TEST(Thread, whose_master_is_lost_is_left_by_the_declared_way) {
  expect_left(MasterFault::lost, [](Lathe& m) { m.spindle.readable = false; });
}

TEST(Thread, whose_master_stands_or_turns_back_is_left_by_the_declared_way) {
  expect_left(
      MasterFault::reversed, [](Lathe& m) { m.spindle.wanted = -10.0; }, 1e9);
}

TEST(Thread, whose_master_is_further_off_than_its_window_is_left_by_the_declared_way) {
  expect_left(
      MasterFault::window, [](Lathe& m) { m.spindle.load = [](double) { return 30.0; }; }, 0.002);
}

TEST(Thread, whose_master_is_lost_while_it_runs_in_is_left_and_while_it_brakes_ends_at_its_end) {
  for (const bool runs_in : {true, false}) {
    Lathe m;
    m.add(thread_to(0, -60, 1.5));
    m.planner.finish();
    const double z = runs_in ? -0.05 : -59.8;
    ASSERT_TRUE(m.until([&](const Sample& s) { return s.position[2] < z; }));
    m.spindle.readable = false;
    ASSERT_TRUE(m.until(
        [](const Sample& s) { return s.state == FollowerState::stopped || s.state == FollowerState::idle; }));
    const Sample& last = m.trip.samples.back();
    EXPECT_EQ(last.state, runs_in ? FollowerState::stopped : FollowerState::idle);
    EXPECT_NEAR(last.position[0], runs_in ? 2.0 : 0.0, 1e-9);
    EXPECT_TRUE(runs_in || std::abs(last.position[2] + 60.0) < 1e-9);
    EXPECT_LE(m.limits(), 1.001);
  }
}

TEST(Thread, that_is_stopped_is_left_by_the_declared_way_and_goes_on_from_there) {
  Lathe m;
  m.add(thread_to(0, -60, 1.5));
  m.into_thread();
  m.follower.stop();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
  const Vector at = m.trip.samples.back().position;
  EXPECT_NEAR(at[0], 2.0, 1e-9);
  m.planner.restart(at);
  m.add(line_to(10, 0, 0, 50));
  ASSERT_TRUE(m.finish());
  EXPECT_NEAR(m.trip.samples.back().position[0], 10.0, 1e-9);
}

TEST(Thread, does_not_begin_where_the_axes_are_too_slow_for_it_or_its_way_too_short) {
  for (const bool fast : {true, false}) {
    Lathe m;
    if (fast) m.spindle.wanted = m.spindle.w = 200.0;
    m.add(thread_to(0, fast ? -200.0 : -0.5, fast ? 5.0 : 4.0, fast ? 12000.0 : 600.0));
    m.planner.finish();
    ASSERT_TRUE(m.until([](const Sample& s) { return s.master.fault != MasterFault::none; }));
    const ByMaster master = m.trip.samples.back().master;
    EXPECT_EQ(master.fault, fast ? MasterFault::too_fast : MasterFault::too_short);
    EXPECT_GT(fast ? master.value : master.limit, fast ? master.limit : master.value);
    ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
    EXPECT_EQ(m.trip.samples.back().position, Vector{}) << "nothing has moved";
  }
}

TEST(Thread, whose_spindle_is_not_told_to_turn_does_not_begin_and_says_so) {
  Lathe m;
  m.spindle.wanted = m.spindle.w = 0.0;
  m.spindle.ordered = 0.0;
  m.add(thread_to(0, -60, 1.5));
  m.planner.finish();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.master.fault != MasterFault::none; }, 50));
  EXPECT_EQ(m.trip.samples.back().master.fault, MasterFault::stands);
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }, 50));
  EXPECT_EQ(m.trip.samples.back().position, Vector{});
}

TEST(Thread, whose_spindle_does_not_come_to_its_speed_waits_for_its_ramp_and_no_longer_than_its_patience) {
  Lathe m;
  m.spindle.wanted = m.spindle.w = 0.0;
  m.add(thread_to(0, -60, 1.5));
  m.planner.finish();
  const auto fault = [](const Sample& s) { return s.master.fault != MasterFault::none; };
  ASSERT_FALSE(m.until(fault, 10000)) << "ten seconds";
  ASSERT_TRUE(m.until(fault, 2000));
  EXPECT_EQ(m.trip.samples.back().master.fault, MasterFault::stands);
  EXPECT_GT(m.trip.samples.back().master.value, m.trip.samples.back().master.limit);
}

TEST(Thread, chain_that_grows_faster_is_left_inside_of_the_limits_of_the_axis_that_goes_off) {
  // The second lead is four times the first one, on a taper: X has little left of its speed there.
  Config config = lathe();
  config.threads.window = 1e9;
  config.threads.retract = {30.0, 0.0, 0.0};
  Lathe m(config);
  m.spindle.wanted = m.spindle.w = 50.0;
  Element slow = thread_to(30, -30, 1.5, 3000.0), fast = thread_to(150, -150, 6.0, 3000.0);
  slow.lock.per_turn = 1.5 * std::sqrt(2.0);
  fast.lock.per_turn = 6.0 * std::sqrt(2.0);
  m.add(slow);
  m.add(fast);
  m.planner.finish();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.master.locked && s.position[2] < -70.0; })) << m.why();
  m.follower.stop();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
  EXPECT_LE(m.limits(), 1.001);
}

/// `parts` blocks of 0.5 mm, of two leads in turn that differ so little that the thread is one of their mean;
/// none shares a span with its neighbour.
void add_chain(Lathe& m, int parts) {
  m.lead = 2.0 / (1.0 / 1.5 + 1.0 / 1.503);
  for (int n = 1; n <= parts; ++n) m.add(thread_to(0, -0.5 * n, n % 2 == 0 ? 1.503 : 1.5));
}

TEST(Thread, chain_of_any_number_of_parts_begins_and_keeps_its_angle_to_its_end) {
  for (const int parts : {60, 130, 1000}) {
    Lathe m;
    add_chain(m, parts);
    ASSERT_TRUE(m.finish()) << m.why();
    EXPECT_NEAR(m.trip.samples.back().position[2], -0.5 * parts, 1e-9);
    EXPECT_GT(m.locked, 100 * parts / 15) << "10 revolutions/s, 1.5 mm in each: most of the way is locked";
    EXPECT_LE(m.worst_mm, 0.012);
    EXPECT_LE(m.limits(), 1.001);
  }
}

TEST(Thread, chain_whose_end_is_far_away_in_time_begins_before_it_is_known) {
  Config slow = lathe();
  for (AxisLimits& axis : slow.limits) axis.velocity = 20.0;
  Lathe m(slow);
  m.lead = 1.5;
  for (int n = 1; n <= 12; ++n) {  // 9 s at the fastest, of which 2 s are planned ahead
    while (!m.planner.wants_more()) m.step();
    Element e = thread_to(n % 2 == 0 ? 0.0 : 0.2, -15.0 * n, 1.5);
    e.lock.per_turn = 1.5 * std::hypot(0.2, 15.0) / 15.0;
    m.add(e);
  }
  ASSERT_TRUE(m.finish()) << m.why();
  EXPECT_NEAR(m.trip.samples.back().position[2], -180.0, 1e-9);
  EXPECT_LE(m.worst_mm, 0.020);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_whose_rest_is_not_planned_in_time_is_left_by_the_declared_way) {
  Lathe m;
  add_chain(m, 400);  // and no end of it
  ASSERT_TRUE(m.until([](const Sample& s) { return s.master.fault != MasterFault::none; }));
  EXPECT_EQ(m.trip.samples.back().master.fault, MasterFault::starved);
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
  EXPECT_GT(m.trip.samples.back().position[2], -200.0) << "it does not come to where nothing is known";
  EXPECT_GT(m.trip.samples.back().position[0], 1.9) << "off the part, by the retract";
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, chain_is_left_inside_of_the_limits_wherever_its_master_fails) {
  using Break = void (*)(Lathe&);
  const struct {
    MasterFault fault;
    Break break_it;
  } kFaults[] = {{MasterFault::lost, [](Lathe& m) { m.spindle.readable = false; }},
                 {MasterFault::reversed, [](Lathe& m) { m.spindle.wanted = -10.0; }},
                 {MasterFault::window, [](Lathe& m) { m.spindle.load = [](double) { return 30.0; }; }}};
  for (const auto& [fault, break_it] : kFaults)
    for (const double z : {-0.2, -1.0, -25.0, -26.1, -63.7, -99.0, -120.3}) {
      Config config = lathe();
      config.threads.window = fault == MasterFault::window ? 0.002 : 1e9;
      Lathe m(config);
      add_chain(m, 250);
      m.planner.finish();
      ASSERT_TRUE(m.until([&](const Sample& s) { return s.position[2] < z; })) << z;
      break_it(m);
      ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; })) << z;
      EXPECT_NE(m.why(), "no fault") << z;
      EXPECT_GT(m.trip.samples.back().position[2], -125.0);
      EXPECT_NEAR(m.trip.samples.back().position[0], 2.0, 1e-6) << "off the part, at " << z;
      EXPECT_LE(m.limits(), 1.001) << z;
    }
}

TEST(Thread, chain_whose_later_parts_allow_less_is_cut_inside_of_their_limits) {
  Config config = lathe();
  config.limits[0].acceleration = 100.0;
  config.limits[0].jerk = 1000.0;
  Lathe m(config);
  for (int n = 1; n <= 200; ++n) {
    const double x = n < 150 || n % 2 == 0 ? 0.0 : 0.003;
    m.add(thread_to(x, -0.5 * n, n % 2 == 0 ? 1.503 : 1.5));
  }
  ASSERT_TRUE(m.finish()) << m.why();
  EXPECT_NEAR(m.trip.samples.back().position[2], -100.0, 1e-9);
  EXPECT_LE(m.limits(), 1.001);
}

TEST(Thread, is_left_to_the_end_of_the_travel_and_no_further) {
  for (const double sign : {1.0, -1.0}) {
    Config config = lathe();
    config.threads.retract = {2.0 * sign, 0.0, 0.0};
    config.threads.travel_max[0] = config.threads.travel_min[0] = 1.2 * sign;
    Lathe m(config);
    m.add(thread_to(0, -60, 1.5));
    m.into_thread();
    m.follower.stop();
    ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
    EXPECT_NEAR(m.trip.samples.back().position[0], 1.2 * sign, 1e-9);
  }
}

TEST(Thread, is_left_to_the_other_side_or_not_at_all_where_its_elements_say_so) {
  for (const bool stays : {true, false}) {
    Lathe m;
    Element e = thread_to(0, -60, 1.5);
    (stays ? e.lock.stays : e.lock.against) = 1;
    m.add(e);
    m.into_thread();
    m.follower.stop();
    ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::stopped; }));
    EXPECT_NEAR(m.trip.samples.back().position[0], stays ? 0.0 : -2.0, 1e-9);
    EXPECT_LE(m.limits(), 1.001);
  }
}

TEST(Thread, waits_for_a_spindle_that_stands_and_for_one_that_is_not_at_speed) {
  Lathe m;
  m.spindle.wanted = m.spindle.w = 0.0;
  m.add(thread_to(0, -60, 1.5));
  m.planner.finish();
  for (int n = 0; n < 500; ++n) m.step();
  EXPECT_EQ(m.trip.samples.back().position, Vector{});
  EXPECT_EQ(m.trip.samples.back().starved, 0u);
  m.spindle.wanted = 10.0;
  ASSERT_TRUE(m.until([](const Sample& s) { return s.state == FollowerState::idle; }));
}

}  // namespace
}  // namespace servogate::path::test
