// SPDX-License-Identifier: Apache-2.0
// The mill with an axis that its drive homes by itself (6098h): X by method 24, a home switch on the drive's
// own input, or as a test says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;
using Input = mock::DriveSwitch::Input;
namespace alarm = axis::alarm;

machine::LoadResult mill_homing(const std::string& method, const std::string& more = "") {
  return changed_mill([&](std::string& text) {
    replace(text, "method = \"switch_and_index\"",
            "method = \"drive\"\ndrive_method = " + method + "\n" + more);
  });
}

/// A person at the mill whose X drive has its home switch above 60 mm and limit switches where the test wants
/// them; whatever the drive does, nothing may ever be a following error or a jump.
class DriveHoming : public testing::Test {
 protected:
  void start(const machine::LoadResult& machine) {
    ASSERT_TRUE(machine.ok()) << (machine.findings.empty()
                                      ? std::string()
                                      : machine.findings.front().str(text::Language::english));
    mill = std::make_unique<Mill>(machine, "");
    drive = mill->control().world().drive("can.x");
    mill->after_cycle = [this] {
      const double x = mill->true_position(0);
      drive->set_input(Input::home, x > home_from);
      drive->set_input(Input::positive_limit, x > limit_plus_from);
      drive->set_input(Input::negative_limit, x < limit_minus_from);
      worst_error = std::max(worst_error, std::abs(mill->axis("X").following_error));
      highest = std::max(highest, x);
    };
    ASSERT_TRUE(mill->power_on()) << mill->alarm_list();
    ASSERT_EQ(mill->ask(RequestKind::mode, static_cast<double>(image::Mode::home)), Refusal::none);
  }
  Refusal home_x() { return mill->ask(RequestKind::home, 0.0, 0); }
  const image::AxisImage& x() const { return mill->axis("X"); }
  bool drive_homes() {
    return mill->until(
        [&] { return x().drive.homing == image::DriveHoming::running && x().drive.velocity_counts_s != 0; },
        5.0);
  }
  bool at_rest_in_csp() {
    return mill->until([&] { return !x().moving && x().drive.mode == image::DriveMode::csp; }, 10.0);
  }
  void expect_alarms(std::initializer_list<image::AlarmNumber> numbers) {
    for (const image::AlarmNumber n : numbers)
      EXPECT_EQ(mill->alarms(n), 1) << n << " of " << mill->alarm_list();
    EXPECT_EQ(mill->control().cycle().alarms().history().size(), numbers.size()) << mill->alarm_list();
  }

  std::unique_ptr<Mill> mill;
  mock::SimulatedDrive* drive = nullptr;
  double home_from = 60.0, limit_plus_from = 1e9, limit_minus_from = -1e9, worst_error = 0.0, highest = -1e9;
};

TEST_F(DriveHoming, the_set_point_follows_the_drive_and_is_seated_on_its_new_zero) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24", "acceleration = \"400 mm/s2\"")));
  EXPECT_EQ(drive->object(0x6098), 24);
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return x().homed && !x().moving; }, 30.0)) << mill->alarm_list();
  mill->run(0.5);
  EXPECT_EQ(x().owner, image::AxisOwner::none);
  EXPECT_TRUE(x().in_position);
  EXPECT_EQ(x().drive.mode, image::DriveMode::csp);
  EXPECT_NEAR(x().actual, 0.0, 0.01) << "final_position";
  // The edge of the drive's switch is home.position now: 0 in the mill's file.
  EXPECT_NEAR(mill->true_position(0), home_from, 0.05);
  EXPECT_LT(worst_error, 0.5);
  expect_alarms({});
  // It follows a program's set-points at once.
  ASSERT_EQ(mill->ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  ASSERT_EQ(mill->ask(RequestKind::jog_increment, -10.0, 0), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return !x().moving && x().in_position; }, 10.0));
  EXPECT_NEAR(mill->true_position(0), home_from - 10.0, 0.05);
  expect_alarms({});
}

TEST_F(DriveHoming, twice_comes_to_the_same_place_though_the_drive_still_shows_the_end_of_the_first) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24")));
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(home_x(), Refusal::none);
    ASSERT_TRUE(mill->until([&] { return x().homed && !x().moving; }, 30.0)) << mill->alarm_list();
    mill->run(0.2);
    EXPECT_NEAR(mill->true_position(0), home_from, 0.05) << i;
  }
  expect_alarms({});
}

TEST_F(DriveHoming, a_homing_error_of_the_drive_stops_it_and_is_named) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24")));  // it turns round at the first limit, not at the second
  limit_plus_from = 55.0;
  limit_minus_from = 20.0;
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return mill->alarms(alarm::kHomingDriveFailed) > 0; }, 30.0))
      << mill->alarm_list();
  ASSERT_TRUE(at_rest_in_csp());
  EXPECT_FALSE(x().homed);
  EXPECT_EQ(x().drive.state, image::DriveState::operation_enabled);
  EXPECT_LT(highest, 58.0);
  expect_alarms({alarm::kHomingDriveFailed});
}

TEST_F(DriveHoming, that_takes_too_long_is_halted) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24", "timeout = \"2 s\"")));
  home_from = 1e9;
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return mill->alarms(alarm::kHomingTimeout) > 0; }, 5.0))
      << mill->alarm_list();
  const double there = mill->true_position(0);
  ASSERT_TRUE(at_rest_in_csp());
  EXPECT_LT(std::abs(mill->true_position(0) - there), 5.0);
  mill->run(1.0);
  EXPECT_EQ(x().drive.state, image::DriveState::operation_enabled);
  EXPECT_EQ(drive->velocity_counts_s(), 0.0);
  expect_alarms({alarm::kHomingTimeout});
}

TEST_F(DriveHoming, a_stop_halts_the_drive_where_it_is_and_it_keeps_the_axis) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24")));
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(drive_homes());
  mill->run(0.3);
  const double there = mill->true_position(0);
  ASSERT_EQ(mill->ask(RequestKind::stop), Refusal::none);
  ASSERT_TRUE(at_rest_in_csp()) << mill->alarm_list();
  mill->run(1.0);
  EXPECT_LT(std::abs(mill->true_position(0) - there), 3.0);
  EXPECT_FALSE(x().homed);
  EXPECT_EQ(x().drive.state, image::DriveState::operation_enabled);
  EXPECT_EQ(x().owner, image::AxisOwner::none);
  expect_alarms({});
  ASSERT_EQ(home_x(), Refusal::none) << "and may home again";
  ASSERT_TRUE(mill->until([&] { return x().homed && !x().moving; }, 30.0)) << mill->alarm_list();
  EXPECT_NEAR(mill->true_position(0), home_from, 0.05);
}

TEST_F(DriveHoming, a_stop_of_a_drive_without_halt_is_its_quick_stop_and_takes_the_power) {
  const Scratch scratch;
  std::string device = read_all(source("devices/servo-cia402.toml"));
  replace(device, "[behaviour]", "[behaviour]\nhalt = false");
  scratch.write("servo-no-halt.toml", device);
  setenv("SERVOGATE_DEVICES", scratch.path("").c_str(), 1);
  const machine::LoadResult machine = changed_mill([&](std::string& text) {
    replace(text, "method = \"switch_and_index\"", "method = \"drive\"\ndrive_method = 24");
    replace(text, "device = \"servo-cia402\"", "device = \"servo-no-halt\"");
  });
  unsetenv("SERVOGATE_DEVICES");
  ASSERT_NO_FATAL_FAILURE(start(machine));
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(drive_homes());
  mill->run(0.3);
  const double there = mill->true_position(0);
  ASSERT_EQ(mill->ask(RequestKind::stop), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return x().drive.state < image::DriveState::operation_enabled; }, 3.0))
      << mill->alarm_list();
  mill->run(1.0);
  EXPECT_LT(std::abs(mill->true_position(0) - there), 3.0) << "by its ramp, it does not coast";
  EXPECT_EQ(x().drive.mode, image::DriveMode::csp);
  EXPECT_FALSE(x().homed);
  expect_alarms({});
  ASSERT_EQ(mill->ask(RequestKind::power, 1.0), Refusal::none) << "unasked it does not come on again";
}

TEST_F(DriveHoming, the_emergency_stop_takes_the_power_and_the_mode_back) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24")));
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(drive_homes());
  mill->run(0.2);
  mill->control().world().set_input("estop_chain_ok", false);
  ASSERT_TRUE(mill->until([&] { return x().drive.state <= image::DriveState::switched_on; }, 3.0));
  mill->run(1.0);
  EXPECT_FALSE(x().homed);
  EXPECT_EQ(x().drive.mode, image::DriveMode::csp);
  EXPECT_EQ(mill->alarms(alarm::kHomingInterrupted), 1) << mill->alarm_list();
}

TEST_F(DriveHoming, a_drive_that_falls_out_of_operation_enabled_ends_it) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("24")));
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(drive_homes());
  mill->inject("can.x", fault::Kind::over_current);
  ASSERT_TRUE(mill->until([&] { return mill->alarms(alarm::kDriveFault) > 0; }, 3.0)) << mill->alarm_list();
  mill->run(0.5);
  EXPECT_FALSE(x().homed);
  EXPECT_FALSE(x().moving);
  EXPECT_EQ(mill->alarms(alarm::kHomingInterrupted), 1) << mill->alarm_list();
  EXPECT_EQ(mill->alarms(alarm::kEncoderJump), 0);
  EXPECT_EQ(mill->alarms(alarm::kFollowingError), 0);
}

TEST_F(DriveHoming, on_a_limit_switch_of_the_control_that_the_method_does_not_use_is_halted) {
  ASSERT_NO_FATAL_FAILURE(start(mill_homing("20")));
  home_from = 1e9;
  mill->control().world().play_input("x_limit_plus", {.value = 1.0});
  ASSERT_EQ(home_x(), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return mill->alarms(alarm::kHomingLimitAgain) > 0; }, 5.0))
      << mill->alarm_list();
  ASSERT_TRUE(at_rest_in_csp());
  expect_alarms({alarm::kHomingLimitAgain});
}

TEST_F(DriveHoming, by_a_method_that_the_drive_does_not_have_is_refused_at_boot_with_the_number) {
  Mill other(mill_homing("36"), "");
  EXPECT_FALSE(other.power_on());
  const auto history = other.control().cycle().alarms().history();
  ASSERT_FALSE(history.empty());
  EXPECT_EQ(image::render(history.front(), other.control().alarm_names(), text::Language::english),
            "node 1 (can.x, axis X): boot stopped at step \"homing by the drive\": reading 60E3h:00 "
            "Supported homing "
            "methods: 36 is none of the 32 that the device has");
}

}  // namespace
}  // namespace servogate::machine_run
