// SPDX-License-Identifier: Apache-2.0
// A spindle that becomes a rotary axis, and a spindle again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::axis {
namespace {

constexpr double kCounts = 3600.0, kMark = 777.0;

/// One drive that is told a speed or a position, with the mode that it shows some cycles after it is told.
class Shared {
 public:
  explicit Shared(int axis_direction = 1) {
    SpindleConfig s;
    s.counts_numerator = static_cast<std::int64_t>(kCounts);
    s.axis = 0;
    spindle.configure(s, 0);
    AxisConfig a;
    a.rotary = true;
    a.travel_limited = false;
    a.counts_numerator = 10;  // a degree
    a.count_direction = axis_direction;
    a.limits = {180.0, 1000.0, 20000.0};
    a.slow_velocity = 20.0;
    a.homing.method = HomingMethod::none;
    axis.configure(a, 0);
    axis.sleep(0.0);
    axis.request_power(true);
    permit(true);
    image.axis_count = image.spindle_count = 1;
  }
  /// It turns, and was told to become the axis so many cycles ago.
  void is_on_its_way(int cycles) {
    spindle.order(SpindleMode::cw, 600.0);
    run(600);
    spindle.want_axis(true);
    run(cycles);
  }
  void permit(bool on) {
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), on);
    const std::uint32_t s = image::spindle_base(0), a = image::axis_base(0);
    image.packets.set_bit(image::at(image::field(image::kSpindleFields, "enable"), s), on);
    image.packets.set_bit(image::at(image::field(image::kAxisFields, "enable"), a), on);
    image.packets.set_bit(image::at(image::field(image::kAxisFields, "feed_enable"), a), on);
  }
  void drive() {
    image::SpindleImage& s = image.spindles[0];
    const image::DriveCommand& c = s.drive_command;
    shows = c.mode == told_mode ? std::min(shows + 1, 20) : 0;
    told_mode = c.mode;
    if (shows == 5) s.drive.mode = c.mode;
    const bool on = c.power && !fault && s.drive.mode == c.mode;
    if (was_on && on && c.mode != was_mode) changed_under_power = true;
    if (on && c.mode == image::DriveMode::csp) {
      const double target = static_cast<double>(c.position_counts) - shift;
      if (!was_on) jump = std::max(jump, std::abs(target - position));
      speed = (target - position) / 0.001;
    } else if (on) {
      speed += (c.velocity_counts_s - speed) * 0.2;
    } else {
      speed *= 0.999;
    }
    const double before = position;
    position += speed * 0.001;
    const auto whole = [](double at) { return std::floor((at - kMark) / kCounts); };
    if (marks && c.latch_arm && whole(before) != whole(position)) {
      s.drive.latch_counts =
          static_cast<std::int64_t>(shift + kMark + kCounts * whole(std::max(before, position)));
      ++s.drive.latch_sequence;
    }
    s.drive.online = online;
    s.drive.state = fault ? image::DriveState::fault
                    : on  ? image::DriveState::operation_enabled
                          : image::DriveState::switch_on_disabled;
    s.drive.position_counts = std::llround(position + shift);
    was_on = on;
    was_mode = c.mode;
  }
  void cycle() {
    image.now.t_ns += image.now.period_ns;
    drive();
    spindle.show_drive(image);
    axis.read(image);
    spindle.read(image);
    spindle.share(axis, 0.001);
    axis.react(reaction);
    spindle.react(reaction);
    axis.command(image);
    spindle.command(image);
    for (const Event& e : axis.events()) events.push_back(e);
    for (const Event& e : spindle.events()) events.push_back(e);
  }
  void run(int n) {
    while (n-- > 0) cycle();
  }
  template <class Met>
  bool until(Met met, int patience = 20000) {
    while (!met() && patience-- > 0) cycle();
    return met();
  }
  bool becomes_axis() {
    spindle.want_axis(true);
    return until([&] { return spindle.is_axis(); });
  }
  bool becomes_spindle() {
    spindle.want_axis(false);
    return until([&] { return spindle.is_spindle(); });
  }
  /// Degrees from the mark at which it truly stands, in the sense of the axis.
  double degrees() const { return axis.config().count_direction * (position - kMark) / kCounts * 360.0; }
  static double off(double a, double b) { return std::abs(a - b - 360.0 * std::round((a - b) / 360.0)); }
  bool raised(image::AlarmNumber number) const {
    return std::any_of(events.begin(), events.end(), [&](const Event& e) { return e.number == number; });
  }

  image::ProcessImage image;
  Axis axis;
  Spindle spindle;
  image::Reaction reaction = image::Reaction::none;
  std::vector<Event> events;
  double speed = 0.0, position = 0.0, jump = 0.0;
  double shift = 0.0;  ///< of the counts, since the drive was switched on
  bool fault = false, online = true, marks = true, was_on = false, changed_under_power = false;
  image::DriveMode told_mode = image::DriveMode::none, was_mode = image::DriveMode::none;
  int shows = 0;
};

TEST(SpindleAxis, that_turns_comes_to_rest_at_the_place_of_its_axis_and_is_it) {
  for (const int direction : {1, -1}) {
    Shared m(direction);
    m.spindle.order(SpindleMode::cw, 1500.0);
    m.run(1000);
    ASSERT_TRUE(m.becomes_axis());
    EXPECT_EQ(m.axis.setpoint().x, 0.0);
    EXPECT_LE(Shared::off(m.degrees(), 0.0), 0.11) << "a count";
    EXPECT_TRUE(m.axis.homed());
    EXPECT_TRUE(m.axis.motion_permitted());
    EXPECT_EQ(m.image.spindles[0].drive.mode, image::DriveMode::csp);
    EXPECT_FALSE(m.changed_under_power) << "the drive is off while its mode changes";
    EXPECT_LE(m.jump, 1.0) << "counts, when it comes on as an axis";
    EXPECT_TRUE(m.events.empty());
  }
}

TEST(SpindleAxis, moves_by_its_angle_and_turns_again_as_a_spindle) {
  Shared m;
  ASSERT_TRUE(m.becomes_axis());
  ASSERT_TRUE(m.axis.move_to(123.4, 90.0));
  ASSERT_TRUE(m.until([&] { return !m.axis.moving() && m.axis.in_position(); }));
  EXPECT_LE(Shared::off(m.degrees(), 123.4), 0.11);
  ASSERT_TRUE(m.becomes_spindle());
  EXPECT_TRUE(m.axis.asleep());
  EXPECT_EQ(m.spindle.mode(), SpindleMode::stop);
  m.run(200);
  EXPECT_FALSE(m.image.spindles[0].drive_command.power) << "at rest, without an order";
  m.spindle.order(SpindleMode::ccw, 1000.0);
  m.run(1500);
  EXPECT_TRUE(m.spindle.at_speed());
  EXPECT_NEAR(m.spindle.actual_rpm(), -1000.0, 5.0);
  EXPECT_EQ(m.axis.setpoint().x, 123.4) << "its place is kept";
  EXPECT_TRUE(m.events.empty()) << "an encoder that runs is no jump of the axis";
  ASSERT_TRUE(m.becomes_axis());
  EXPECT_EQ(m.axis.setpoint().x, 123.4);
  EXPECT_LE(Shared::off(m.degrees(), 123.4), 0.11);
  EXPECT_FALSE(m.changed_under_power);
  EXPECT_TRUE(m.events.empty());
}

TEST(SpindleAxis, keeps_the_turns_that_an_endless_axis_has_made) {
  Shared m;
  ASSERT_TRUE(m.becomes_axis());
  ASSERT_TRUE(m.axis.move_to(1000.0, 180.0));
  ASSERT_TRUE(m.until([&] { return !m.axis.moving() && m.axis.in_position(); }));
  ASSERT_TRUE(m.becomes_spindle());
  m.spindle.order(SpindleMode::cw, 600.0);
  m.run(3000);
  ASSERT_TRUE(m.becomes_axis());
  EXPECT_EQ(m.axis.setpoint().x, 1000.0);
  EXPECT_LE(Shared::off(m.degrees(), 1000.0), 0.11);
}

TEST(SpindleAxis, takes_no_order_to_turn_while_it_is_one) {
  Shared m;
  ASSERT_TRUE(m.becomes_axis());
  const double before = m.position;
  for (const int order : {0, 1, 2, 3}) {
    m.events.clear();
    if (order == 0) m.spindle.order(SpindleMode::cw, 100.0);
    if (order == 1) m.spindle.order(SpindleMode::orient, 0.0);
    if (order == 2) m.spindle.turn(90.0, 10.0);
    if (order == 3) m.spindle.couple({});
    m.run(500);
    EXPECT_TRUE(m.raised(alarm::kSpindleIsAxis)) << order;
    EXPECT_EQ(m.position, before) << order;
    EXPECT_TRUE(m.spindle.is_axis());
  }
}

TEST(SpindleAxis, whose_axis_sleeps_refuses_its_motion) {
  Shared m;
  EXPECT_FALSE(m.axis.move_to(10.0, 10.0));
  EXPECT_FALSE(m.axis.jog_increment(1.0));
  EXPECT_FALSE(m.axis.home());
  m.spindle.order(SpindleMode::cw, 600.0);
  m.run(1000);
  EXPECT_FALSE(m.axis.move_to(10.0, 10.0));
  EXPECT_EQ(m.axis.setpoint().x, 0.0);
}

TEST(SpindleAxis, waits_for_whoever_moves_the_axis_before_it_is_a_spindle_again) {
  Shared m;
  ASSERT_TRUE(m.becomes_axis());
  ASSERT_TRUE(m.axis.move_to(180.0, 90.0));
  m.spindle.want_axis(false);
  m.run(500);
  EXPECT_TRUE(m.axis.moving());
  EXPECT_TRUE(m.spindle.is_axis());
  ASSERT_TRUE(m.until([&] { return m.spindle.is_spindle(); }));
  EXPECT_EQ(m.axis.setpoint().x, 180.0);
}

TEST(SpindleAxis, whose_drive_trips_stops_either_way_and_stays_off_when_it_is_acknowledged) {
  Shared as_axis;
  ASSERT_TRUE(as_axis.becomes_axis());
  ASSERT_TRUE(as_axis.axis.move_to(180.0, 90.0));
  as_axis.run(500);
  as_axis.fault = true;
  as_axis.run(10);
  EXPECT_TRUE(as_axis.raised(alarm::kDriveFault));
  EXPECT_FALSE(as_axis.raised(alarm::kSpindleDriveFault)) << "it is said once";
  ASSERT_TRUE(as_axis.becomes_spindle());
  as_axis.run(3000);
  EXPECT_FALSE(as_axis.raised(alarm::kSpindleDriveFault));
  EXPECT_TRUE(as_axis.axis.present(alarm::kDriveFault)) << "no reset as long as it is there";

  Shared turning;
  turning.spindle.order(SpindleMode::cw, 1500.0);
  turning.run(1000);
  turning.spindle.want_axis(true);
  turning.run(100);
  turning.fault = true;
  turning.run(10);
  EXPECT_TRUE(turning.raised(alarm::kSpindleDriveFault));
  EXPECT_FALSE(turning.raised(alarm::kDriveFault));
  EXPECT_FALSE(turning.spindle.wants_axis()) << "the change has ended with it";

  for (Shared* m : {&as_axis, &turning}) {
    m->speed = 0.0;
    m->axis.reset();
    m->spindle.reset();
    m->fault = false;
    m->run(100);
    const double before = m->position;
    m->run(3000);
    EXPECT_EQ(m->position, before);
    EXPECT_TRUE(m->spindle.is_spindle());
  }
}

TEST(SpindleAxis, whose_drive_goes_away_is_a_spindle_and_finds_its_place_by_the_mark_again) {
  // Cycles behind the order: while it turns down, changes its mode, is placed, and stands as the axis.
  for (int after = 50; after < 4000; after += 211) {
    Shared m;
    m.is_on_its_way(after);
    const bool of_axis = m.image.spindles[0].is_axis;
    m.online = false;
    m.fault = true;  // it has no power meanwhile
    m.run(100);
    EXPECT_FALSE(m.spindle.wants_axis()) << after;
    EXPECT_EQ(m.raised(alarm::kDriveOffline), of_axis) << after;
    EXPECT_EQ(m.raised(alarm::kSpindleNoAxis), !of_axis) << after << ": it is said once";
    m.speed = 0.0;
    m.position += 1234.0;  // somebody turns the chuck, and the drive counts from another zero
    m.shift = -98765.0;
    m.online = true;
    m.fault = false;
    m.axis.reset();
    m.spindle.reset();
    const double before = m.position;
    m.run(3000);
    EXPECT_EQ(m.position, before) << after << ": nothing turns unasked";
    EXPECT_TRUE(m.spindle.is_spindle()) << after;
    EXPECT_TRUE(m.axis.asleep()) << after;
    m.events.clear();
    m.axis.request_power(true);
    ASSERT_TRUE(m.becomes_axis()) << after;
    EXPECT_EQ(m.axis.setpoint().x, 0.0) << after;
    EXPECT_LE(Shared::off(m.degrees(), 0.0), 0.11) << after;
    EXPECT_TRUE(m.events.empty()) << after;
  }
}

TEST(SpindleAxis, that_is_told_to_become_one_without_its_drive_says_so_at_once) {
  Shared m;
  m.online = false;
  m.run(10);
  m.spindle.want_axis(true);
  m.run(10);
  EXPECT_TRUE(m.raised(alarm::kSpindleNoAxis));
  EXPECT_TRUE(m.spindle.is_spindle());
}

TEST(SpindleAxis, that_sags_without_power_goes_on_where_it_was_told_to_stand) {
  Shared m;
  ASSERT_TRUE(m.becomes_axis());
  ASSERT_TRUE(m.axis.move_to(90.0, 90.0));
  ASSERT_TRUE(m.until([&] { return !m.axis.moving() && m.axis.in_position(); }));
  m.spindle.want_axis(false);
  ASSERT_TRUE(m.until([&] { return !m.was_on; }));
  m.position += 7.0;
  ASSERT_TRUE(m.until([&] { return m.spindle.is_spindle(); }));
  EXPECT_EQ(m.axis.setpoint().x, 90.0);
  ASSERT_TRUE(m.becomes_axis());
  EXPECT_LE(Shared::off(m.degrees(), 90.0), 0.11);
}

TEST(SpindleAxis, whose_feed_is_withdrawn_on_the_way_to_its_place_waits_and_goes_on) {
  Shared m;
  const image::Place feed = image::at(image::field(image::kAxisFields, "feed_enable"), image::axis_base(0));
  m.spindle.order(SpindleMode::cw, 300.0);
  m.run(500);
  m.spindle.want_axis(true);
  ASSERT_TRUE(m.until([&] { return m.image.spindles[0].is_axis; }));
  m.position += 20.0;  // without power, by hand
  ASSERT_TRUE(m.until([&] { return m.axis.moving(); }));
  m.image.packets.set_bit(feed, false);
  m.run(2000);
  EXPECT_FALSE(m.axis.moving());
  EXPECT_FALSE(m.spindle.is_axis());
  m.image.packets.set_bit(feed, true);
  ASSERT_TRUE(m.until([&] { return m.spindle.is_axis(); }));
  EXPECT_LE(Shared::off(m.degrees(), 0.0), 0.11);
  EXPECT_TRUE(m.events.empty());
}

TEST(SpindleAxis, loses_its_power_in_an_emergency_stop_in_every_phase_of_the_change) {
  // Cycles behind the order: while it turns down, is placed, is powered, and stands as the axis.
  for (int after = 0; after < 4000; after += 97) {
    Shared m;
    m.is_on_its_way(after);
    m.reaction = image::Reaction::stop_and_power_off;
    m.run(3000);
    EXPECT_FALSE(m.image.spindles[0].drive_command.power) << after;
    m.spindle.want_axis(false);
    m.reaction = image::Reaction::none;
    m.run(100);
    const double before = m.position;
    m.run(1000);
    EXPECT_NEAR(m.position, before, 1.0) << after;
    EXPECT_TRUE(m.spindle.is_spindle()) << after;
    EXPECT_FALSE(m.changed_under_power) << after;
  }
}

TEST(SpindleAxis, that_cannot_become_one_says_so_and_stays_a_spindle_at_rest) {
  Shared no_mark;
  no_mark.marks = false;
  no_mark.spindle.want_axis(true);
  no_mark.run(25000);
  EXPECT_TRUE(no_mark.raised(alarm::kSpindleNoAxis));
  EXPECT_TRUE(no_mark.spindle.is_spindle());
  EXPECT_TRUE(no_mark.spindle.zero_speed());

  Shared no_power;
  no_power.axis.request_power(false);
  no_power.spindle.want_axis(true);
  no_power.run(25000);
  EXPECT_TRUE(no_power.raised(alarm::kSpindleNoAxis));
  EXPECT_TRUE(no_power.spindle.is_spindle());
}

TEST(SpindleAxis, that_is_called_back_on_its_way_is_a_spindle_at_rest) {
  for (int after = 1; after < 3000; after += 61) {
    Shared m;
    m.is_on_its_way(after);
    ASSERT_TRUE(m.becomes_spindle()) << after;
    m.run(2000);
    EXPECT_TRUE(m.spindle.zero_speed()) << after;
    EXPECT_TRUE(m.events.empty()) << after;
  }
}

}  // namespace
}  // namespace servogate::axis
