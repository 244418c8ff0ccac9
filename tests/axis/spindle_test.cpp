// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/spindle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::axis {
namespace {

/// A CSV drive with an encoder: follows the speed with a short lag, zero mark once a revolution.
class SpindleRig {
 public:
  explicit SpindleRig(SpindleConfig config = {}) {
    spindle.configure(config, 0);
    set("enable", true);
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
  }
  void set(std::string_view name, double value) {
    for (const auto& f : image::kSpindleFields)
      if (f.name == name) image.packets.set_number(place(f), value);
  }
  double get(std::string_view name) const {
    for (const auto& f : image::kSpindleFields)
      if (f.name == name) return image.packets.number(place(f));
    return -1e99;
  }
  void cycle() {
    image.now.t_ns += image.now.period_ns;
    image::SpindleImage& s = image.spindles[0];
    const bool quick = s.drive_command.power && s.drive_command.quick_stop && !fault;
    const bool on = s.drive_command.power && !quick && !fault;
    if (on)
      speed += (s.drive_command.velocity_counts_s - speed) * 0.2;
    else
      speed *= quick ? 0.99 : 0.9999;  // the drive's own ramp; without power the spindle coasts
    if (blocked) speed = 0.0;
    const double before = position;
    position += speed * 0.001;
    const auto revolution = 4096.0;
    if (marks && s.drive_command.latch_arm &&
        std::floor((before - mark) / revolution) != std::floor((position - mark) / revolution)) {
      s.drive.latch_counts = static_cast<std::int64_t>(
          mark + revolution * std::floor((std::max(before, position) - mark) / revolution));
      ++s.drive.latch_sequence;
    }
    s.drive.online = !away;
    s.drive.state = fault   ? image::DriveState::fault
                    : quick ? image::DriveState::quick_stop_active
                    : on    ? image::DriveState::operation_enabled
                            : image::DriveState::switch_on_disabled;
    s.drive.error_code = fault ? 0x2310 : 0;
    s.drive.missed = silent ? s.drive.missed + 1 : 0;
    if (!silent) s.drive.position_counts = std::llround(position);
    spindle.read(image);
    spindle.react(reaction);
    spindle.command(image);
    for (const Event& e : spindle.events()) events.push_back(e);
    const double now = image.spindles[0].command_rpm;
    steepest = std::max(steepest, std::abs(now - last_command) / 0.001);
    last_command = now;
  }
  void run(int n) {
    while (n-- > 0) cycle();
  }
  static image::Place place(const image::InterfaceField& f) {
    const std::uint32_t byte = image::spindle_base(0) + f.byte;
    return {image::Packet::k, f.format,
            f.format == image::Format::bl ? byte * 8 + f.bit : byte / image::format_size(f.format), 1};
  }

  image::ProcessImage image;
  Spindle spindle;
  image::Reaction reaction = image::Reaction::none;
  std::vector<Event> events;
  double speed = 0.0, position = 0.0, mark = 777.0, steepest = 0.0, last_command = 0.0;
  bool fault = false, blocked = false, silent = false;
  bool away = false;  ///< silent: its process data do not come
  bool marks = true;  ///< the drive captures its zero mark
};

TEST(Spindle, ramps_to_its_speed_and_says_when_it_is_there) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 1500.0);
  rig.run(400);
  EXPECT_FALSE(rig.spindle.at_speed());
  EXPECT_EQ(rig.get("run"), 1.0);
  EXPECT_EQ(rig.get("cw"), 1.0);
  rig.run(400);
  EXPECT_TRUE(rig.spindle.at_speed());
  EXPECT_NEAR(rig.spindle.actual_rpm(), 1500.0, 5.0);
  EXPECT_NEAR(rig.image.spindles[0].drive_command.velocity_counts_s, 1500.0 / 60.0 * 4096.0, 1e-6);
  EXPECT_LE(rig.steepest, 3000.0 + 1e-6);
  EXPECT_NEAR(rig.get("actual"), 1500.0, 5.0);
  EXPECT_EQ(rig.get("at_speed"), 1.0);
}

TEST(Spindle, turns_the_other_way_through_zero_on_the_same_ramp) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 1000.0);
  rig.run(600);
  rig.spindle.order(SpindleMode::ccw, 1000.0);
  rig.run(1000);
  EXPECT_TRUE(rig.spindle.at_speed());
  EXPECT_NEAR(rig.spindle.actual_rpm(), -1000.0, 5.0);
  EXPECT_LE(rig.steepest, 3000.0 + 1e-6);
  rig.spindle.order(SpindleMode::stop, 0.0);
  rig.run(600);
  EXPECT_TRUE(rig.spindle.settled());
  EXPECT_EQ(rig.get("zero_speed"), 1.0);
  rig.run(1200);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.power);
}

TEST(Spindle, takes_the_override_of_the_plc_and_the_limits_of_its_configuration) {
  SpindleConfig c;
  c.max_rpm = 2000.0, c.min_rpm = 100.0;
  SpindleRig rig(c);
  rig.set("override", 50);
  rig.spindle.order(SpindleMode::cw, 1000.0);
  rig.run(1000);
  EXPECT_NEAR(rig.spindle.actual_rpm(), 500.0, 5.0);
  rig.set("override", 125);
  rig.spindle.order(SpindleMode::cw, 1900.0);
  rig.run(1500);
  EXPECT_NEAR(rig.spindle.actual_rpm(), 2000.0, 5.0);
  rig.set("override", 0);
  rig.spindle.order(SpindleMode::cw, 1.0);
  EXPECT_EQ(rig.spindle.ordered_rpm(), 100.0);
}

TEST(Spindle, never_turns_faster_than_the_chuck_permits_and_slows_down_when_that_falls) {
  SpindleRig rig;
  rig.set("limit", 800.0);
  rig.spindle.order(SpindleMode::cw, 1500.0);
  rig.set("override", 125.0);
  rig.run(1000);
  EXPECT_NEAR(rig.image.spindles[0].command_rpm, 800.0, 1e-9);
  EXPECT_TRUE(rig.spindle.at_speed());
  rig.set("limit", 300.0);
  rig.run(1000);
  EXPECT_NEAR(rig.image.spindles[0].command_rpm, 300.0, 1e-9);
  EXPECT_LE(rig.steepest, 3000.0 + 1e-6);
  rig.set("limit", 0.0);
  rig.set("override", 100.0);
  rig.run(1000);
  EXPECT_NEAR(rig.image.spindles[0].command_rpm, 1500.0, 1e-9);
}

TEST(Spindle, counts_whole_revolutions_from_its_zero_mark_with_the_time_that_they_are_of) {
  SpindleConfig c;
  c.encoder_delay = 0.003;
  SpindleRig rig(c);
  EXPECT_FALSE(rig.spindle.angle().valid);
  rig.spindle.order(SpindleMode::cw, 1500.0);
  rig.run(3000);
  SpindleAngle angle = rig.spindle.angle();
  EXPECT_TRUE(angle.valid);
  EXPECT_NEAR(static_cast<double>(angle.turns) + angle.part, (rig.position - rig.mark) / 4096.0,
              0.5 / 4096.0);
  EXPECT_EQ(angle.at_ns, rig.image.now.t_ns - rig.image.now.period_ns - 3'000'000);
  rig.spindle.order(SpindleMode::ccw, 1500.0);
  rig.run(6000);
  angle = rig.spindle.angle();
  EXPECT_LT(angle.turns, 0);
  EXPECT_GE(angle.part, 0.0);
  EXPECT_NEAR(static_cast<double>(angle.turns) + angle.part, (rig.position - rig.mark) / 4096.0,
              0.5 / 4096.0);
  rig.silent = true;
  rig.cycle();
  EXPECT_EQ(rig.spindle.angle().at_ns, angle.at_ns) << "what did not come is no news";
}

TEST(Spindle, of_a_drive_without_a_zero_mark_counts_from_where_it_was_switched_on) {
  SpindleRig rig;
  rig.marks = false;
  rig.position = 100.0;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(250);
  EXPECT_FALSE(rig.spindle.angle().valid) << "it may still come";
  rig.run(1000);
  const SpindleAngle angle = rig.spindle.angle();
  ASSERT_TRUE(angle.valid);
  EXPECT_NEAR(static_cast<double>(angle.turns) + angle.part, (rig.position - 100.0) / 4096.0, 0.5 / 4096.0);
}

TEST(Spindle, does_not_turn_without_the_enable_of_the_plc) {
  SpindleRig rig;
  rig.set("enable", false);
  rig.spindle.order(SpindleMode::cw, 1000.0);
  rig.run(500);
  EXPECT_EQ(rig.position, 0.0);
  EXPECT_FALSE(rig.spindle.at_speed());
  rig.set("enable", true);
  rig.run(1000);
  EXPECT_TRUE(rig.spindle.at_speed());
  rig.set("enable", false);
  rig.run(1000);
  EXPECT_TRUE(rig.spindle.zero_speed());
  EXPECT_TRUE(rig.events.empty());
}

TEST(Spindle, stops_oriented_at_the_angle_from_standstill_and_out_of_motion) {
  for (const double rpm : {0.0, 2000.0, -700.0}) {
    SpindleConfig c;
    c.orient_angle = 90.0;
    SpindleRig rig(c);
    rig.spindle.order(rpm < 0 ? SpindleMode::ccw : SpindleMode::cw, std::abs(rpm));
    rig.run(1500);
    rig.spindle.order(SpindleMode::orient, 0.0);
    rig.run(5000);
    EXPECT_TRUE(rig.spindle.oriented()) << rpm;
    EXPECT_TRUE(rig.spindle.settled());
    const double true_angle = (rig.position - rig.mark) / 4096.0 * 360.0;
    EXPECT_NEAR(std::remainder(true_angle - 90.0, 360.0), 0.0, 0.5) << rpm;
    EXPECT_TRUE(rig.events.empty());
    EXPECT_LE(rig.steepest, 3000.0 + 1e-6);
  }
}

TEST(Spindle, turns_on_by_angles_from_its_oriented_stop_at_the_speed_of_the_turn) {
  SpindleConfig c;
  c.orient_angle = 90.0;
  SpindleRig rig(c);
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.run(5000);
  ASSERT_TRUE(rig.spindle.oriented());
  double wanted = 90.0;
  const auto angle = [&] { return (rig.position - rig.mark) / 4096.0 * 360.0; };
  wanted += 360.0 * std::round((angle() - wanted) / 360.0);
  for (const auto& [degrees, rpm] :
       {std::pair{720.0, 100.0}, {-90.0, 60.0}, {45.0, 200.0}, {-3600.0, 600.0}}) {
    rig.spindle.turn(degrees, rpm);
    EXPECT_FALSE(rig.spindle.settled());
    wanted += degrees;
    double fastest = 0.0;
    for (int i = 0; i < 20'000 && !rig.spindle.settled(); ++i) {
      rig.cycle();
      fastest = std::max(fastest, std::abs(rig.last_command));
    }
    rig.run(500);
    EXPECT_TRUE(rig.spindle.oriented()) << degrees;
    EXPECT_NEAR(angle(), wanted, 0.6) << degrees;
    EXPECT_LE(fastest, rpm + 1e-6) << degrees;
  }
  EXPECT_TRUE(rig.events.empty());
  EXPECT_LE(rig.steepest, 3000.0 + 1e-6);
}

TEST(Spindle, whose_angle_is_not_known_does_not_turn_by_one) {
  SpindleRig rig;
  rig.run(10);
  rig.spindle.turn(90.0, 100.0);
  rig.run(1000);
  EXPECT_EQ(rig.speed, 0.0);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleOrientTimeout);
}

TEST(Spindle, that_turns_by_an_angle_stops_without_the_enable_and_reaches_its_angle_with_it) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.run(5000);
  ASSERT_TRUE(rig.spindle.oriented());
  const double from = rig.position;
  rig.spindle.turn(1800.0, 100.0);
  rig.run(1000);
  rig.set("enable", false);
  rig.run(1000);
  EXPECT_TRUE(rig.spindle.zero_speed());
  EXPECT_FALSE(rig.spindle.settled());
  rig.set("enable", true);
  rig.run(10'000);
  EXPECT_TRUE(rig.spindle.settled());
  EXPECT_NEAR((rig.position - from) / 4096.0, 5.0, 0.005);
}

TEST(Spindle, whose_drive_went_away_in_a_turn_by_an_angle_does_not_turn_on_when_it_is_back) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.run(5000);
  ASSERT_TRUE(rig.spindle.oriented());
  rig.spindle.turn(36'000.0, 100.0);
  rig.run(1000);
  rig.away = true;
  rig.run(100);
  rig.away = false;
  rig.run(3000);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
  EXPECT_EQ(rig.last_command, 0.0) << "what turns yet is what coasts";
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleOrientTimeout);
}

TEST(Spindle, that_turns_by_an_angle_is_bounded_by_its_chuck) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.run(5000);
  rig.set("limit", 60.0);
  rig.spindle.turn(3600.0, 600.0);
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    rig.cycle();
    fastest = std::max(fastest, std::abs(rig.last_command));
  }
  EXPECT_NEAR(fastest, 60.0, 1e-6);
}

TEST(Spindle, names_what_keeps_it_from_its_speed_or_angle) {
  SpindleRig rig;
  rig.blocked = true;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(11'000);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleNotAtSpeed);
  EXPECT_EQ(rig.events[0].limit, 600.0);
  rig.events.clear();
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.run(11'000);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleOrientTimeout);
}

TEST(Spindle, whose_speed_is_adjusted_in_every_cycle_is_supervised_all_the_same) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(500);
  for (int i = 0; i < 500; ++i) {
    rig.spindle.adjust(600.0 + i);
    rig.cycle();
  }
  EXPECT_NEAR(rig.spindle.actual_rpm(), 1099.0, 60.0);
  EXPECT_TRUE(rig.events.empty());
  rig.blocked = true;
  for (int i = 0; i < 11'000; ++i) {
    rig.spindle.adjust(1099.0);
    rig.cycle();
  }
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleNotAtSpeed);
}

TEST(Spindle, reports_the_fault_of_its_drive_once_and_resets_it) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(100);
  rig.fault = true;
  rig.run(100);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleDriveFault);
  EXPECT_EQ(rig.events[0].value, 0x2310);
  EXPECT_TRUE(rig.spindle.present(alarm::kSpindleDriveFault));
  rig.spindle.reset();
  rig.run(1);
  EXPECT_TRUE(rig.image.spindles[0].drive_command.reset_fault);
  rig.fault = false;
  rig.run(2);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.reset_fault);
  EXPECT_FALSE(rig.spindle.present(alarm::kSpindleDriveFault));
}

TEST(Spindle, goes_off_with_the_reaction_power_off_and_stays_off) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(500);
  rig.reaction = image::Reaction::power_off;
  rig.run(1);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.power);
  rig.reaction = image::Reaction::none;
  rig.run(2000);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.power);
}

TEST(Spindle, brakes_by_the_drive_in_a_quick_stop_and_loses_its_power_at_rest) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(500);
  rig.reaction = image::Reaction::quick_stop;
  int cycles = 0;
  for (; !rig.get("zero_speed") && cycles < 5000; ++cycles) {
    rig.run(1);
    ASSERT_TRUE(rig.image.spindles[0].drive_command.power) << "it would coast, cycle " << cycles;
  }
  EXPECT_LT(cycles, 1000);
  rig.run(1500);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.power);
}

TEST(Spindle, ramps_to_rest_before_its_power_goes_with_the_reaction_stop_and_power_off) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 600.0);
  rig.run(500);
  rig.reaction = image::Reaction::stop_and_power_off;
  int cycles = 0;
  for (; !rig.get("zero_speed") && cycles < 5000; ++cycles) {
    rig.run(1);
    ASSERT_TRUE(rig.image.spindles[0].drive_command.power) << "it would coast, cycle " << cycles;
    ASSERT_FALSE(rig.image.spindles[0].drive_command.quick_stop);
  }
  EXPECT_LT(cycles, 2000);
  rig.run(1500);
  EXPECT_FALSE(rig.image.spindles[0].drive_command.power);
  rig.reaction = image::Reaction::none;
  rig.run(1500);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
}

TEST(Spindle, refuses_an_oriented_stop_where_nothing_gives_an_angle) {
  SpindleConfig c;
  c.encoder = false;
  SpindleRig rig(c);
  rig.spindle.order(SpindleMode::orient, 0.0);
  rig.spindle.order(rig.spindle.mode(), 100.0);  // as a constant surface speed orders anew
  rig.run(100);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, alarm::kSpindleNoEncoder);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
}

TEST(Spindle, keeps_its_angle_exact_over_a_long_run) {
  SpindleConfig c;
  c.counts_numerator = 8191;  // 2730.33 counts a revolution
  c.counts_denominator = 3;
  Spindle s;
  s.configure(c, 0);
  image::ProcessImage image;
  image.spindles[0].drive.online = true;
  for (const std::int64_t turns : {0LL, 3LL, 3'000'000'000LL, -3'000'000'000LL}) {
    image.spindles[0].drive.position_counts = turns * 8191 / 3 + 1000;
    s.read(image);
    EXPECT_NEAR(s.angle_deg(), 1000.0 * 3 / 8191 * 360.0, 1e-9) << turns;
  }
}

TEST(Spindle, whose_drive_trips_does_not_turn_again_when_it_is_acknowledged) {
  for (const SpindleMode told : {SpindleMode::cw, SpindleMode::ccw, SpindleMode::orient}) {
    SpindleRig rig;
    rig.spindle.order(SpindleMode::cw, 1000.0);
    rig.run(800);
    if (told != SpindleMode::cw) rig.spindle.order(told, 1000.0);
    rig.fault = true;
    rig.run(100);
    rig.speed = 0.0;  // it has come to a stand
    rig.run(100);
    ASSERT_TRUE(rig.spindle.present(alarm::kSpindleDriveFault));
    EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
    rig.spindle.reset();
    rig.fault = false;
    const double before = rig.position;
    for (int n = 0; n < 3000; ++n) {
      rig.cycle();
      ASSERT_FALSE(rig.image.spindles[0].drive_command.power) << "its drive is not even switched on";
    }
    EXPECT_EQ(rig.position, before);
    rig.spindle.order(SpindleMode::cw, 500.0);
    rig.run(1000);
    EXPECT_TRUE(rig.spindle.at_speed()) << "it turns when it is told to again";
  }
}

TEST(Spindle, whose_drive_goes_away_does_not_turn_again_when_it_is_back) {
  SpindleRig rig;
  rig.spindle.order(SpindleMode::cw, 1000.0);
  rig.run(800);
  rig.away = true;
  rig.run(100);
  EXPECT_EQ(rig.spindle.mode(), SpindleMode::stop);
  rig.away = false;
  rig.speed = 0.0;
  const double before = rig.position;
  rig.run(3000);
  EXPECT_EQ(rig.position, before);
}

}  // namespace
}  // namespace servogate::axis
