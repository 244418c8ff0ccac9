// SPDX-License-Identifier: Apache-2.0
// Two spindles of which one follows the angle of the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/spindle.hpp"
#include "tests/property_seed.hpp"

namespace servogate::axis {
namespace {

constexpr double kCounts = 4096.0;

SpindleConfig config(CouplingBy by = CouplingBy::none) {
  SpindleConfig c;
  c.max_rpm = 4000.0;
  c.acceleration = 2000.0;
  c.coupling = by;
  c.coupling_window = 3.0;
  return c;
}

/// Two CSV drives with inertia whose zero marks lie anywhere.
class Pair {
 public:
  explicit Pair(CouplingBy by, double follower_acceleration = 2000.0, double window_deg = 3.0,
                bool thread_by_setpoint = false) {
    SpindleConfig first = config(), second = config(by);
    first.thread_by_setpoint = thread_by_setpoint;
    second.acceleration = follower_acceleration;
    second.coupling_window = window_deg;
    spindles[0].configure(first, 0);
    spindles[1].configure(second, 1);
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
    for (int n = 0; n < 2; ++n) set(n, "enable", 1.0);
  }
  void set(int n, std::string_view name, double value) {
    for (const image::InterfaceField& f : image::kSpindleFields) {
      const std::uint32_t byte = image::spindle_base(n) + f.byte;
      if (f.name == name)
        image.packets.set_number(
            {image::Packet::k, f.format,
             f.format == image::Format::bl ? byte * 8 + f.bit : byte / image::format_size(f.format), 1},
            value);
    }
  }
  void drive(std::size_t n) {
    image::SpindleImage& s = image.spindles[n];
    const bool on = s.drive_command.power && !dead[n];
    if (on)
      speed[n] += std::clamp((s.drive_command.velocity_counts_s - speed[n]) * 0.2, -limit[n], limit[n]);
    else
      speed[n] *= 0.999;
    if (load[n] != 0.0) speed[n] *= 1.0 - load[n];
    const double before = position[n];
    position[n] += speed[n] * 0.001;
    const auto whole = [&](double counts) { return std::floor((counts - mark[n]) / kCounts); };
    if (s.drive_command.latch_arm && whole(before) != whole(position[n])) {
      s.drive.latch_counts =
          static_cast<std::int64_t>(mark[n] + kCounts * whole(std::max(before, position[n])));
      ++s.drive.latch_sequence;
    }
    s.drive.online = online[n];
    s.drive.state = on ? image::DriveState::operation_enabled : image::DriveState::switch_on_disabled;
    s.drive.position_counts = std::llround(position[n]);
  }
  void cycle() {
    image.now.t_ns += image.now.period_ns;
    for (std::size_t n = 0; n < 2; ++n) drive(n);
    for (Spindle& s : spindles) s.read(image);
    command_all(spindles, reaction, image);
    for (const Spindle& s : spindles)
      for (const Event& e : s.events()) events.push_back(e);
    const double now = image.spindles[1].command_rpm;
    steepest = std::max(steepest, std::abs(now - last) / 0.001);
    last = now;
    if (watching) worst = std::max(worst, std::abs(true_error()));
  }
  void run(int n) {
    while (n-- > 0) cycle();
  }
  bool until_synchronous(int patience = 10000) {
    while (!spindles[1].synchronous() && patience-- > 0) cycle();
    return spindles[1].synchronous();
  }
  /// Degrees that the follower truly is off its nearest equal place at this moment.
  double true_error() const {
    const double leader = (position[0] - mark[0]) / kCounts, follower = (position[1] - mark[1]) / kCounts;
    const double off = (leader * ratio + phase / 360.0 - follower) * equal;
    return 360.0 * (off - std::round(off)) / equal;
  }
  void couple(int p, int q, double phase_deg = 0.0) {
    ratio = static_cast<double>(q) / p;
    equal = p;
    phase = phase_deg;
    spindles[1].couple({p, q, phase_deg});
  }
  bool raised(image::AlarmNumber number) const {
    return std::any_of(events.begin(), events.end(), [&](const Event& e) { return e.number == number; });
  }

  image::ProcessImage image;
  std::array<Spindle, 2> spindles;
  image::Reaction reaction = image::Reaction::none;
  std::vector<Event> events;
  std::array<double, 2> speed{}, position{}, load{}, mark{777.0, 2100.0}, limit{1e9, 1e9};
  std::array<bool, 2> dead{}, online{true, true};
  double ratio = 1.0, phase = 0.0, equal = 1.0, steepest = 0.0, last = 0.0, worst = 0.0;
  bool watching = false;
};

TEST(Coupling, leads_the_second_spindle_at_the_ratio_and_the_phase_that_are_programmed) {
  for (const CouplingBy by : {CouplingBy::setpoint, CouplingBy::measured})
    for (const auto& [p, q, phase] : {std::tuple{1, 2, 0.0}, {2, 3, 30.0}, {2, -3, -45.0}, {3, 1, 120.0}}) {
      Pair m(by);
      m.spindles[0].order(SpindleMode::cw, 900.0);
      m.run(1000);
      m.couple(p, q, phase);
      ASSERT_TRUE(m.until_synchronous()) << p << ":" << q;
      m.run(2000);
      m.watching = true;
      m.run(2000);
      EXPECT_NEAR(m.spindles[1].actual_rpm(), 900.0 * q / p, 2.0);
      // Counts of both, and by the measured angle what the filter leaves of them.
      EXPECT_LE(m.worst, 0.5) << p << ":" << q << " " << phase;
      EXPECT_TRUE(m.events.empty());
      EXPECT_LE(m.steepest, 2000.0 + 1e-6);
    }
}

TEST(Coupling, shows_how_far_the_second_spindle_is_off_its_angle) {
  for (const CouplingBy by : {CouplingBy::setpoint, CouplingBy::measured}) {
    Pair m(by);
    const image::SpindleImage &leader = m.image.spindles[0], &follower = m.image.spindles[1];
    m.spindles[0].order(SpindleMode::cw, 900.0);
    m.couple(3, 2);
    double farthest = 0.0, untrue = 0.0;
    for (int n = 0; n < 6000; ++n) {
      m.cycle();
      if (!follower.coupled) continue;
      farthest = std::max(farthest, std::abs(follower.phase_error_deg));
      if (m.spindles[1].synchronous())
        untrue = std::max(untrue, std::abs(follower.phase_error_deg - m.true_error()));
    }
    ASSERT_TRUE(follower.coupled && m.spindles[1].synchronous());
    EXPECT_LE(farthest, 61.0) << "three places are equal: the nearest one is at most 60 degrees off";
    EXPECT_LE(untrue, 1.0) << "counts, and what both turn in a cycle";
    EXPECT_FALSE(leader.coupled);
    m.load[1] = 0.05;
    m.run(20);
    m.load[1] = 0.0;
    EXPECT_GT(follower.phase_error_deg, 0.2) << "a load holds it behind";
    m.spindles[1].uncouple();
    m.run(2);
    EXPECT_FALSE(follower.coupled);
    EXPECT_EQ(follower.phase_error_deg, 0.0);
  }
}

TEST(Coupling, stays_in_step_while_the_first_spindle_changes_its_speed_and_stops) {
  for (const CouplingBy by : {CouplingBy::setpoint, CouplingBy::measured}) {
    Pair m(by, 2000.0, 6.0);
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(800);
    m.couple(1, 2);
    ASSERT_TRUE(m.until_synchronous());
    m.run(1000);
    m.watching = true;
    m.spindles[0].adjust(1000.0);
    m.run(1500);
    m.spindles[0].order(SpindleMode::stop, 0.0);
    m.run(1600);
    std::printf("coupled by %s, changes of speed: at most %.3f degrees off\n",
                by == CouplingBy::setpoint ? "set-point" : "measured angle", m.worst);
    // By the set-point both lag alike. By the measured angle: acceleration x lag of the drive (5 ms, and 4
    // cycles there and back) / gain of the position loop, and what the filter takes to see the acceleration.
    const double turns_s2 = 1600.0 / 60.0, lag_s = 0.009, gain = 20.0,
                 forgets = path::MasterEstimate::kForgets;
    const double bound = 360.0 * turns_s2 * (lag_s / gain + 0.5 / (forgets * forgets));
    EXPECT_LE(m.worst, by == CouplingBy::setpoint ? 0.1 : bound);
    EXPECT_TRUE(m.spindles[1].synchronous());
    EXPECT_TRUE(m.spindles[1].zero_speed());
    for (const Event& e : m.events) ADD_FAILURE() << e.number << " " << e.value;
  }
}

TEST(Coupling, has_the_first_spindle_turn_no_faster_and_ramp_no_steeper_than_the_second_can_follow) {
  Pair m(CouplingBy::setpoint, 500.0);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(1000);
  m.couple(1, 2);
  ASSERT_TRUE(m.until_synchronous());
  m.watching = true;
  m.spindles[0].adjust(3500.0);
  m.run(20000);
  EXPECT_NEAR(m.spindles[0].actual_rpm(), 0.98 * 4000.0 / 2.0, 5.0);
  EXPECT_TRUE(m.spindles[0].at_speed());
  EXPECT_LE(m.steepest, 500.0 + 1e-6);
  EXPECT_LE(m.worst, 3.0);
  EXPECT_TRUE(m.events.empty());
}

TEST(Coupling, behind_a_spindle_that_changes_its_speed_at_random_stays_within_its_bound_and_its_limits) {
  std::mt19937_64 random(test::property_seed());
  for (int n = 0; n < 20; ++n) {
    const CouplingBy by = n % 2 == 0 ? CouplingBy::setpoint : CouplingBy::measured;
    const int p = static_cast<int>(random() % 4) + 1, q = static_cast<int>(random() % 3) + 1;
    Pair m(by, 2000.0, 90.0);
    const auto speed = [&] { return 300.0 + static_cast<double>(random() % 600); };
    m.spindles[0].order(SpindleMode::cw, speed());
    m.run(1000);
    m.couple(p, random() % 2 == 0 ? q : -q, static_cast<double>(random() % 360));
    ASSERT_TRUE(m.until_synchronous()) << n;
    m.run(1000);
    m.watching = true;
    double steepest = 0.0, last = m.image.spindles[1].drive_command.velocity_counts_s;
    for (int change = 0; change < 8; ++change) {
      m.spindles[0].adjust(speed());
      for (int k = 0; k < 400; ++k) {
        m.cycle();
        const double now = m.image.spindles[1].drive_command.velocity_counts_s;
        steepest = std::max(steepest, std::abs(now - last) / kCounts * 60.0 * 1e3);
        last = now;
      }
    }
    // As above, and where one change follows upon another what is left of it.
    const double turns_s2 = std::min(0.8 * 2000.0, 2000.0 * q / p) / 60.0,
                 forgets = path::MasterEstimate::kForgets;
    const double bound = by == CouplingBy::setpoint
                             ? 0.5
                             : 2.0 * 360.0 * turns_s2 * (0.009 / 20.0 + 0.5 / (forgets * forgets)) + 0.5;
    EXPECT_LE(m.worst, std::min(bound, 180.0 / p)) << n << ": " << p << ":" << q;
    EXPECT_LE(steepest, 2.0 * 2000.0 + 1e-6) << "the ramp and the position loop, each by its own";
    EXPECT_TRUE(m.events.empty()) << n;
  }
}

TEST(Coupling, that_loses_synchronism_under_a_load_says_so_once_and_goes_on) {
  Pair m(CouplingBy::setpoint);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(800);
  m.couple(1, 1);
  ASSERT_TRUE(m.until_synchronous());
  m.load[1] = 0.05;
  m.run(200);
  m.load[1] = 0.0;
  EXPECT_TRUE(m.raised(alarm::kSpindleSyncLost));
  EXPECT_EQ(m.events.size(), 1u);
  EXPECT_GT(m.events[0].value, m.events[0].limit);
  EXPECT_TRUE(m.spindles[1].coupled());
  EXPECT_TRUE(m.until_synchronous()) << "it comes back into step";
}

TEST(Coupling, whose_second_spindle_does_not_turn_is_an_alarm) {
  Pair m(CouplingBy::measured);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(800);
  m.limit[1] = 0.0;
  m.couple(1, 1);
  m.run(12000);
  EXPECT_FALSE(m.spindles[1].synchronous());
  EXPECT_TRUE(m.raised(alarm::kSpindleNotSynchronous));
}

TEST(Coupling, whose_drive_goes_away_ends_with_an_alarm_and_does_not_turn_on_when_it_is_back) {
  for (const std::size_t gone : {std::size_t{0}, std::size_t{1}}) {
    Pair m(CouplingBy::measured);
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(800);
    m.couple(1, 1);
    ASSERT_TRUE(m.until_synchronous());
    m.online[gone] = false;
    m.run(100);
    EXPECT_TRUE(m.raised(alarm::kSpindleSyncLost)) << gone;
    EXPECT_FALSE(m.spindles[1].coupled());
    m.online[gone] = true;
    m.run(8000);  // without power it coasts
    EXPECT_TRUE(m.spindles[1].zero_speed());
  }
}

TEST(Coupling, takes_no_other_order_to_turn_and_ends_with_a_stop) {
  Pair m(CouplingBy::setpoint);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(800);
  m.couple(1, 1);
  ASSERT_TRUE(m.until_synchronous());
  m.spindles[1].order(SpindleMode::ccw, 100.0);
  m.run(10);
  EXPECT_TRUE(m.raised(alarm::kSpindleCoupled));
  EXPECT_TRUE(m.spindles[1].synchronous());
  m.spindles[1].uncouple();
  m.run(1000);
  EXPECT_TRUE(m.spindles[1].zero_speed());
  EXPECT_NEAR(m.spindles[0].actual_rpm(), 600.0, 2.0) << "the first one turns on";
}

/// Cycles until both stand, at most `patience`.
int until_both_stand(Pair& m, int patience) {
  int n = 0;
  for (; n < patience; ++n) {
    m.cycle();
    if (m.spindles[0].zero_speed() && m.spindles[1].zero_speed()) break;
  }
  return n;
}

TEST(Coupling, ramps_both_spindles_down_together_where_the_program_stops_the_first) {
  Pair m(CouplingBy::setpoint, 500.0);
  m.spindles[0].order(SpindleMode::cw, 1000.0);
  m.run(3000);
  m.couple(1, 1);
  ASSERT_TRUE(m.until_synchronous());
  m.run(500);
  m.spindles[0].order(SpindleMode::stop, 0.0);
  double apart = 0.0;
  for (int n = 0; n < 3500; ++n) {
    m.cycle();
    apart = std::max(apart, std::abs(m.spindles[0].actual_rpm() - m.spindles[1].actual_rpm()));
  }
  EXPECT_LE(apart, 30.0);
  for (const Spindle& s : m.spindles) EXPECT_TRUE(s.zero_speed());
}

TEST(Coupling, lets_each_spindle_brake_by_its_own_ramp_in_an_emergency_stop) {
  Pair m(CouplingBy::setpoint, 500.0);
  m.spindles[0].order(SpindleMode::cw, 1000.0);
  m.run(3000);
  m.couple(1, 1);
  ASSERT_TRUE(m.until_synchronous());
  m.run(500);
  m.reaction = image::Reaction::stop_and_power_off;
  m.run(550);  // 1000 rpm at 2000 rpm/s, and the lag of the drive
  EXPECT_TRUE(m.spindles[0].zero_speed());
  m.run(1550);  // and at 500 rpm/s
  EXPECT_TRUE(m.spindles[1].zero_speed());
  EXPECT_FALSE(m.spindles[1].coupled());
}

TEST(Coupling, does_not_lengthen_an_emergency_stop_of_spindles_that_are_not_yet_in_step) {
  for (const auto& [p, q] : {std::pair{100, 1}, {1, 20}}) {
    Pair m(CouplingBy::setpoint);
    m.spindles[0].order(SpindleMode::cw, 3000.0);
    m.spindles[1].order(SpindleMode::cw, 3000.0);
    m.run(3000);
    m.couple(p, q);
    m.run(100);
    ASSERT_FALSE(m.spindles[1].synchronous());
    m.reaction = image::Reaction::stop_and_power_off;
    EXPECT_LE(until_both_stand(m, 20000), 2100) << p << ":" << q;
  }
}

TEST(Coupling, does_not_lengthen_a_stop_of_a_first_spindle_whose_second_is_not_yet_in_step) {
  Pair m(CouplingBy::setpoint, 500.0);
  m.spindles[0].order(SpindleMode::cw, 3000.0);
  m.run(3000);
  m.couple(1, 1);
  m.run(100);
  m.spindles[0].order(SpindleMode::stop, 0.0);
  m.run(1550);
  EXPECT_TRUE(m.spindles[0].zero_speed());
}

TEST(Coupling, lets_the_first_spindle_brake_by_its_own_ramp_where_its_enable_or_its_limit_is_taken) {
  for (const auto& [field, value] : {std::pair{"enable", 0.0}, {"limit", 100.0}}) {
    Pair m(CouplingBy::setpoint, 500.0);
    m.spindles[0].order(SpindleMode::cw, 1000.0);
    m.run(3000);
    m.couple(1, 1);
    ASSERT_TRUE(m.until_synchronous());
    m.set(0, field, value);
    m.run(550);
    EXPECT_LE(m.spindles[0].actual_rpm(), 105.0) << field;
    EXPECT_TRUE(m.raised(alarm::kSpindleSyncLost)) << "the second one cannot go with it: " << field;
  }
}

TEST(Coupling, does_not_turn_the_second_spindle_when_the_first_one_is_turned_by_hand) {
  for (const CouplingBy by : {CouplingBy::setpoint, CouplingBy::measured})
    for (const bool stopped : {true, false}) {
      Pair m(by);
      m.spindles[0].order(SpindleMode::cw, 600.0);
      m.run(800);
      m.couple(1, 2);
      ASSERT_TRUE(m.until_synchronous());
      if (stopped)
        m.spindles[0].order(SpindleMode::stop, 0.0);
      else
        m.set(0, "enable", 0.0);
      m.run(3000);
      ASSERT_TRUE(m.spindles[1].coupled());
      ASSERT_TRUE(m.spindles[1].zero_speed());
      ASSERT_FALSE(m.image.spindles[0].drive_command.power) << "the first one is free";
      m.events.clear();
      const double before = m.position[1];
      for (int n = 0; n < 2000; ++n) {
        m.speed[0] = kCounts;  // a turn a second
        m.cycle();
      }
      EXPECT_NEAR(m.position[1], before, kCounts / 360.0) << stopped;
      EXPECT_TRUE(m.events.empty());
      m.set(0, "enable", 1.0);
      m.spindles[0].order(SpindleMode::cw, 600.0);
      EXPECT_TRUE(m.until_synchronous()) << "until it is told to turn";
    }
}

TEST(Coupling, whose_second_drive_trips_ends_and_does_not_turn_again_when_it_is_acknowledged) {
  for (const CouplingBy by : {CouplingBy::setpoint, CouplingBy::measured}) {
    Pair m(by);
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(800);
    m.couple(1, 2);
    ASSERT_TRUE(m.until_synchronous());
    m.dead[1] = true;
    m.run(10000);  // it coasts to a stand
    EXPECT_TRUE(m.raised(alarm::kSpindleSyncLost));
    EXPECT_FALSE(m.spindles[1].coupled());
    m.dead[1] = false;
    const double before = m.position[1];
    m.run(2000);
    EXPECT_NEAR(m.position[1], before, kCounts / 10.0);
    EXPECT_TRUE(m.spindles[1].zero_speed());
  }
}

TEST(Coupling, does_not_catch_up_the_turns_that_were_lost_without_the_enable) {
  Pair m(CouplingBy::setpoint);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(800);
  m.couple(1, 2);
  ASSERT_TRUE(m.until_synchronous());
  m.set(1, "enable", 0.0);
  m.run(3000);
  EXPECT_TRUE(m.raised(alarm::kSpindleSyncLost));
  EXPECT_TRUE(m.spindles[1].zero_speed());
  m.set(1, "enable", 1.0);
  double fastest = 0.0;
  for (int n = 0; n < 3000; ++n) {
    m.cycle();
    fastest = std::max(fastest, m.spindles[1].actual_rpm());
  }
  EXPECT_TRUE(m.spindles[1].synchronous());
  EXPECT_LE(fastest, 1200.0 + 60.0) << "half a turn at most is caught up";
}

TEST(Coupling, does_not_catch_up_the_turns_that_were_lost_under_a_load) {
  Pair m(CouplingBy::setpoint);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(800);
  m.couple(1, 1);
  ASSERT_TRUE(m.until_synchronous());
  m.load[1] = 0.5;
  m.run(3000);
  m.load[1] = 0.0;
  const double rest = m.position[1];
  m.run(2000);
  EXPECT_TRUE(m.spindles[1].synchronous());
  EXPECT_LE((m.position[1] - rest) / kCounts, 20.0 + 0.7) << "20 turns, and not those of 3 s behind";
}

TEST(Coupling, of_a_first_spindle_that_stands_turns_nothing) {
  Pair m(CouplingBy::measured);
  m.couple(1, 2);
  m.run(3000);
  EXPECT_EQ(m.position[1], 0.0);
  EXPECT_TRUE(m.events.empty());
  m.spindles[0].order(SpindleMode::cw, 600.0);
  EXPECT_TRUE(m.until_synchronous()) << "as soon as it turns";
}

/// The first spindle alone.
TEST(ThreadBySetpoint, holds_the_spindle_to_its_commanded_angle_and_says_how_far_it_is_behind) {
  for (const bool held : {true, false}) {
    Pair m(CouplingBy::none, 2000.0, 3.0, held);
    Spindle& spindle = m.spindles[0];
    spindle.order(SpindleMode::cw, 900.0);
    m.run(2000);
    EXPECT_EQ(spindle.setpoint_ahead().has_value(), held);
    m.load[0] = 0.002;  // of its speed in a cycle: 1 % less
    m.run(2000);
    EXPECT_NEAR(spindle.actual_rpm(), held ? 900.0 : 891.0, 1.5);
    if (held) {
      EXPECT_NEAR(*spindle.setpoint_ahead(), 0.15 / 20.0, 1e-3) << "what the position loop needs";
    }
    m.load[0] = 0.0;
    m.run(2000);
    if (held) {
      EXPECT_NEAR(*spindle.setpoint_ahead(), 0.0, 1e-3);
    }
    spindle.order(SpindleMode::ccw, 600.0);
    m.run(3000);
    EXPECT_NEAR(spindle.actual_rpm(), -600.0, 1.0);
    if (held) {
      EXPECT_NEAR(*spindle.setpoint_ahead(), 0.0, 1e-3);
    }
    spindle.order(SpindleMode::orient, 0.0);
    m.run(4000);
    EXPECT_TRUE(spindle.oriented());
    EXPECT_FALSE(spindle.setpoint_ahead().has_value()) << "the oriented stop has a position of its own";
    EXPECT_TRUE(m.events.empty());
  }
}

TEST(ThreadBySetpoint, does_not_catch_up_turns_that_were_lost) {
  Pair m(CouplingBy::none, 2000.0, 3.0, true);
  Spindle& spindle = m.spindles[0];
  spindle.order(SpindleMode::cw, 900.0);
  m.run(2000);
  const auto fastest_of = [&](int cycles) {
    double fastest = 0.0;
    while (cycles-- > 0) {
      m.cycle();
      fastest = std::max(fastest, spindle.actual_rpm());
    }
    return fastest;
  };
  m.load[0] = 0.2;  // it hardly turns
  m.run(1000);
  m.load[0] = 0.0;
  EXPECT_LE(fastest_of(3000), 900.0 + 60.0 + 5.0) << "the position loop adds orient_rpm at most";
  EXPECT_NEAR(spindle.actual_rpm(), 900.0, 1.0);
  EXPECT_NEAR(spindle.setpoint_ahead().value(), 0.0, 1e-3) << "it is led from where it was freed";
  m.set(0, "enable", 0.0);
  m.run(1000);
  m.set(0, "enable", 1.0);
  EXPECT_LE(fastest_of(2000), 900.0 + 60.0 + 5.0);
  m.dead[0] = true;
  m.run(3000);
  EXPECT_FALSE(spindle.setpoint_ahead().has_value());
  m.dead[0] = false;
  EXPECT_LE(fastest_of(4000), 900.0 + 60.0 + 5.0);
  EXPECT_NEAR(spindle.setpoint_ahead().value(), 0.0, 1e-3);
}

}  // namespace
}  // namespace servogate::axis
