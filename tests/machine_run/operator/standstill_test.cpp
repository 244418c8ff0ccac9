// SPDX-License-Identifier: Apache-2.0
// What is known of spindles when a control is to end.
#include "gateway/control/run/standstill.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "firmware_if/image/interface_map.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using namespace gateway;

TEST(Standstill, of_a_spindle_whose_drive_answers_no_more_is_not_known_and_of_an_inverter_always_assumed) {
  Mill mill;
  ASSERT_TRUE(mill.power_on()) << mill.alarm_list();
  auto image = std::make_unique<image::ProcessImage>(mill.control().cycle().image());
  machine::MachineConfig machine = mill.control().machine();
  EXPECT_TRUE(spindles_answer(*image, machine));
  EXPECT_TRUE(spindles_rest(*image));
  image->spindles[0].drive.online = false;
  EXPECT_TRUE(spindle_lost(*image, machine, 0));
  EXPECT_FALSE(spindles_answer(*image, machine));
  machine.spindles[0].drive.clear();
  EXPECT_TRUE(spindles_answer(*image, machine)) << "an inverter has no drive that could answer";
}

TEST(Standstill, is_not_reached_while_a_drive_has_torque_or_a_spindle_turns) {
  Mill mill;
  ASSERT_TRUE(mill.power_on()) << mill.alarm_list();
  auto image = std::make_unique<image::ProcessImage>(mill.control().cycle().image());
  EXPECT_FALSE(axes_off(*image));
  for (image::AxisImage& a : image->axes) a.enabled = a.moving = false;
  EXPECT_FALSE(axes_off(*image)) << "the brake closes under torque";
  for (image::AxisImage& a : image->axes) a.drive.state = image::DriveState::switch_on_disabled;
  EXPECT_TRUE(axes_off(*image));
  ASSERT_TRUE(spindles_rest(*image));
  image->spindles[0].drive.online = true;
  image->spindles[0].drive.state = image::DriveState::operation_enabled;
  EXPECT_FALSE(spindles_rest(*image));
  image->spindles[0].drive.state = image::DriveState::switch_on_disabled;
  image->packets.set_bit(image::at(image::field(image::kSpindleFields, "zero_speed"), image::spindle_base(0)),
                         false);
  EXPECT_FALSE(spindles_rest(*image));
}

}  // namespace
}  // namespace servogate::machine_run
