// SPDX-License-Identifier: Apache-2.0
// Gear ranges, alone and in a spindle with each of its suppliers.
#include "kernel/axis/gears/gearbox.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::axis {
namespace {

image::Place place(const char* text) { return *image::parse_place(text); }

/// Low to 500 rpm at 4 : 1, high to 2000 rpm at 1 : 1, each with its output.
GearboxConfig two_gears(bool confirmed = false) {
  GearboxConfig c;
  c.ranges = {{500.0, 1.0, place("SA64"), std::nullopt}, {2000.0, 0.25, place("SA65"), std::nullopt}};
  if (confirmed) {
    c.ranges[0].confirm = place("SA1");
    c.ranges[1].confirm = place("SA2");
  }
  c.change_s = 0.2;
  c.timeout_s = 1.0;
  return c;
}

class GearboxTest : public ::testing::Test {
 protected:
  void configure(bool confirmed) { gears_.configure(two_gears(confirmed)); }
  void run(double seconds, bool slow = true, bool lost = false) {
    for (int n = 0; n < static_cast<int>(std::round(seconds * 1e3)); ++n)
      gears_.step(*image_, slow, lost, 0.001);
  }
  bool bit(const char* at) const { return image_->packets.bit(place(at)); }
  void set(const char* at, bool on) { image_->packets.set_bit(place(at), on); }

  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
  Gearbox gears_;
};

TEST_F(GearboxTest, takes_the_slowest_gear_that_reaches_the_speed_or_the_one_that_is_named) {
  configure(false);
  const auto chosen = [&](double rpm, int number) {
    gears_.choose(rpm, number);
    return gears_.wanted();
  };
  EXPECT_EQ(chosen(100.0, 0), 1);
  EXPECT_EQ(chosen(500.0, 0), 1);
  EXPECT_EQ(chosen(501.0, 0), 2);
  EXPECT_EQ(chosen(9999.0, 0), 2);
  EXPECT_EQ(chosen(100.0, 2), 2);
  EXPECT_EQ(chosen(100.0, 7), 2);
}

TEST_F(GearboxTest, is_in_no_gear_at_the_start_and_drives_no_output_before_one_is_wanted) {
  configure(false);
  run(1.0);
  EXPECT_EQ(gears_.engaged(), 0);
  EXPECT_FALSE(bit("SA64") || bit("SA65"));
  EXPECT_FALSE(gears_.changing());
}

TEST_F(GearboxTest, changes_only_while_the_spindle_is_slow_and_one_output_at_a_time) {
  configure(false);
  gears_.choose(100.0, 0);
  run(1.0, false);
  EXPECT_FALSE(bit("SA64"));
  EXPECT_TRUE(gears_.changing());
  run(0.1);
  EXPECT_TRUE(bit("SA64"));
  EXPECT_EQ(gears_.engaged(), 0) << "not before its time";
  run(0.2);
  EXPECT_EQ(gears_.engaged(), 1);
  gears_.choose(1500.0, 0);
  run(0.5, false);
  EXPECT_EQ(gears_.engaged(), 1) << "what is engaged stays until it may change";
  run(0.3);
  EXPECT_EQ(gears_.engaged(), 2);
  EXPECT_TRUE(bit("SA65"));
  EXPECT_FALSE(bit("SA64"));
  EXPECT_EQ(gears_.ratio(), 0.25);
}

TEST_F(GearboxTest, waits_for_its_confirmation_and_fails_without_it) {
  configure(true);
  gears_.choose(100.0, 0);
  run(0.5);
  EXPECT_TRUE(gears_.changing());
  set("SA1", true);
  run(0.01);
  EXPECT_EQ(gears_.engaged(), 1);
  set("SA1", false);
  run(0.01);
  EXPECT_TRUE(gears_.failed()) << "it has jumped out";
  EXPECT_EQ(gears_.engaged(), 0);
  gears_.choose(1500.0, 0);
  EXPECT_FALSE(gears_.failed());
  run(1.1);
  EXPECT_TRUE(gears_.failed());
}

TEST_F(GearboxTest, knows_no_gear_after_its_station_was_lost_and_engages_it_anew) {
  configure(false);
  gears_.choose(100.0, 0);
  run(0.5);
  ASSERT_EQ(gears_.engaged(), 1);
  run(0.01, true, true);
  EXPECT_EQ(gears_.engaged(), 0);
  run(0.5, false);
  EXPECT_EQ(gears_.engaged(), 0);
  run(0.3);
  EXPECT_EQ(gears_.engaged(), 1);
}

enum class Supplier { drive, inverter_on_a_line, outputs };

/// A spindle with two gears, and a motor behind whatever supplies it: 4096 counts a turn of the motor, whose
/// gear is what the outputs engage.
class GearedSpindle : public ::testing::TestWithParam<Supplier> {
 protected:
  GearedSpindle() {
    SpindleConfig c;
    c.max_rpm = 2000.0;
    c.encoder = false;
    c.gearbox = two_gears(true);
    // The first gear turns the motor four times for one of the spindle.
    c.counts_numerator = 4 * 4096;
    if (GetParam() == Supplier::inverter_on_a_line) c.source = 1;
    if (GetParam() == Supplier::outputs) {
      c.inverter = InverterConfig{place("SA24.RE"), place("SA70"), place("SA71"), 0};
      c.gearbox.ranges[0].ratio = 4.0;
      c.gearbox.ranges[1].ratio = 1.0;
    }
    spindle_.configure(c, 0);
    image_->sources[1].quality = image::Quality::good;
    set("enable", 1.0);
    image_->packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
  }
  void set(std::string_view name, double value) {
    for (const auto& f : image::kSpindleFields)
      if (f.name == name) image_->packets.set_number(image::at(at(f), image::spindle_base(0)), value);
  }
  double get(std::string_view name) const {
    for (const auto& f : image::kSpindleFields)
      if (f.name == name) return image_->packets.number(image::at(at(f), image::spindle_base(0)));
    return -1e99;
  }
  static image::Place at(const image::InterfaceField& f) {
    return {image::Packet::k, f.format,
            f.format == image::Format::bl ? f.byte * 8 + f.bit : f.byte / image::format_size(f.format), 1};
  }
  bool low() const { return image_->packets.bit(place("SA64")); }
  bool high() const { return image_->packets.bit(place("SA65")); }
  /// Of the spindle itself, as its gearbox has it.
  double rpm() const { return low() ? motor_rpm_ / 4.0 : high() ? motor_rpm_ : 0.0; }
  void cycle() {
    image_->now.t_ns += image_->now.period_ns;
    if (confirms_) {
      image_->packets.set_bit(place("SA1"), low());
      image_->packets.set_bit(place("SA2"), high());
    }
    image::SpindleImage& s = image_->spindles[0];
    const bool was_low = low(), was_high = high();
    if (GetParam() == Supplier::outputs) {
      const int way = image_->packets.bit(place("SA70")) ? 1 : image_->packets.bit(place("SA71")) ? -1 : 0;
      motor_rpm_ = way * image_->packets.number(place("SA24.RE"));
    } else {
      s.drive.online = true;
      s.drive.state = s.drive_command.power ? image::DriveState::operation_enabled
                                            : image::DriveState::ready_to_switch_on;
      const double wanted = s.drive_command.power ? s.drive_command.velocity_counts_s / 4096.0 * 60.0 : 0.0;
      motor_rpm_ += (wanted - motor_rpm_) * 0.2;
      s.drive.velocity_counts_s = motor_rpm_ / 60.0 * 4096.0;
    }
    spindle_.read(*image_);
    spindle_.command(*image_);
    for (const Event& e : spindle_.events()) events_.push_back(e.number);
    fastest_ = std::max(fastest_, std::abs(motor_rpm_));
    if ((was_low != low() || was_high != high()) && (was_low || was_high))
      changed_at_ = std::max(changed_at_, std::abs(was_low ? motor_rpm_ / 4.0 : motor_rpm_));
  }
  void run(double seconds) {
    for (int n = 0; n < static_cast<int>(seconds * 1e3); ++n) cycle();
  }

  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
  Spindle spindle_;
  std::vector<image::AlarmNumber> events_;
  bool confirms_ = true;
  double motor_rpm_ = 0.0, fastest_ = 0.0, changed_at_ = 0.0;
};
INSTANTIATE_TEST_SUITE_P(Suppliers, GearedSpindle,
                         ::testing::Values(Supplier::drive, Supplier::inverter_on_a_line, Supplier::outputs));

TEST_P(GearedSpindle, turns_at_its_speed_in_the_gear_of_it) {
  spindle_.order(SpindleMode::cw, 400.0);
  run(0.005);
  EXPECT_FALSE(spindle_.at_speed());
  run(2.0);
  EXPECT_TRUE(low());
  EXPECT_TRUE(spindle_.at_speed());
  EXPECT_EQ(get("gear"), 1.0);
  EXPECT_NEAR(rpm(), 400.0, 2.0);
  EXPECT_NEAR(motor_rpm_, 1600.0, 8.0);
  spindle_.order(SpindleMode::cw, 1500.0);
  run(3.0);
  EXPECT_TRUE(high());
  EXPECT_TRUE(spindle_.at_speed());
  EXPECT_EQ(get("gear"), 2.0);
  EXPECT_NEAR(rpm(), 1500.0, 8.0);
  EXPECT_NEAR(spindle_.actual_rpm(), 1500.0, 8.0);
  EXPECT_LE(changed_at_, 5.0) << "rpm while a gear changed";
  EXPECT_TRUE(events_.empty());
}

TEST_P(GearedSpindle, stays_in_its_gear_for_a_speed_that_is_only_adjusted_and_turns_no_faster_than_it) {
  spindle_.order(SpindleMode::ccw, 400.0);
  run(2.0);
  spindle_.adjust(1500.0);
  run(2.0);
  EXPECT_TRUE(low());
  EXPECT_NEAR(rpm(), -500.0, 3.0);
}

TEST_P(GearedSpindle, takes_the_gear_that_the_plc_wants) {
  spindle_.order(SpindleMode::cw, 400.0);
  run(2.0);
  set("gear_wish", 2.0);
  run(3.0);
  EXPECT_TRUE(high());
  EXPECT_NEAR(rpm(), 400.0, 2.0);
  EXPECT_LE(changed_at_, 5.0);
  EXPECT_TRUE(spindle_.at_speed());
}

TEST_P(GearedSpindle, stops_with_an_alarm_when_its_gear_is_not_confirmed) {
  confirms_ = false;
  spindle_.order(SpindleMode::cw, 400.0);
  run(3.0);
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0], alarm::kSpindleGear);
  EXPECT_EQ(spindle_.mode(), SpindleMode::stop);
  EXPECT_EQ(fastest_, 0.0) << "it has not turned";
  confirms_ = true;
  spindle_.order(SpindleMode::cw, 400.0);
  run(3.0);
  EXPECT_TRUE(spindle_.at_speed()) << "and does with the next order";
}

TEST_P(GearedSpindle, stops_when_the_confirmation_goes_while_it_turns) {
  spindle_.order(SpindleMode::cw, 400.0);
  run(2.0);
  confirms_ = false;
  image_->packets.set_bit(place("SA1"), false);
  run(3.0);
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0], alarm::kSpindleGear);
  EXPECT_NEAR(motor_rpm_, 0.0, 1.0);
}

TEST_P(GearedSpindle, changes_no_gear_without_power) {
  image_->packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), false);
  set("gear_wish", 2.0);
  run(2.0);
  EXPECT_FALSE(low() || high());
}

}  // namespace
}  // namespace servogate::axis
