// SPDX-License-Identifier: Apache-2.0
// A frequency inverter in the velocity mode vl and a drive in profile torque, as simulated drives.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/canopen/master/pair.hpp"

namespace servogate::canopen {
namespace {

using testing::kTurn;
using testing::Pair;

/// In tenths of a turn a minute where the dimension factor says so.
void use_vl(NodeConfig& node, std::int32_t denominator) {
  node.target = DriveTarget::spindle;
  DriveProfile& p = node.profile;
  p.velocity_mode = OperationMode::velocity;
  p.modes = supported_bit(OperationMode::velocity);
  p.rpdo = {};
  p.tpdo = {};
  p.rpdo[0].mapping.add({0x6040, 0, 16});
  p.rpdo[0].mapping.add({0x6042, 0, 16});
  p.tpdo[0].mapping.add({0x6041, 0, 16});
  p.tpdo[0].mapping.add({0x6044, 0, 16});
  p.vl_unit_counts_s = static_cast<double>(kTurn) / 60.0 / denominator;
  if (denominator != 1) p.settings.push_back({0x604C, 2, 4, static_cast<std::uint32_t>(denominator)});
  NodeVl vl;
  vl.least = 50;
  vl.most = 20'000;
  vl.ramp = {10'000, 2};
  vl.dimension_factor[1] = denominator;
  node.setup.vl = vl;
}

struct Inverter : Pair {
  explicit Inverter(const std::function<void(NodeConfig&)>& told) : Pair({}, told) {
    spindle().power = true;
    spindle().mode = image::DriveMode::csv;
  }
  image::DriveCommand& spindle() { return image->spindles[0].drive_command; }
  const image::DriveFeedback& turns() const { return image->spindles[0].drive; }
  bool enabled() {
    return until([this] { return turns().state == image::DriveState::operation_enabled; });
  }
};

TEST(Vl, turns_at_the_speed_asked_for_in_the_unit_of_its_dimension_factor) {
  for (const std::int32_t denominator : {1, 10}) {
    SCOPED_TRACE(denominator);
    Inverter pair([=](NodeConfig& node) { use_vl(node, denominator); });
    ASSERT_TRUE(pair.enabled()) << pair.story;
    const double wanted = -1234.0 / 60.0 * static_cast<double>(kTurn);
    pair.spindle().velocity_counts_s = wanted;
    pair.run(3000);
    EXPECT_EQ(pair.drive->object(0x6042), -1234 * denominator);
    EXPECT_NEAR(pair.turns().velocity_counts_s, wanted, 0.002 * std::abs(wanted));
    EXPECT_NEAR(pair.drive->velocity_counts_s(), wanted, 0.002 * std::abs(wanted));
  }
}

TEST(Vl, gets_its_limits_and_ramps_written) {
  Inverter pair([](NodeConfig& node) { use_vl(node, 10); });
  ASSERT_TRUE(pair.enabled()) << pair.story;
  EXPECT_EQ(pair.drive->object(0x6046, 1), 50);
  EXPECT_EQ(pair.drive->object(0x6046, 2), 20'000);
  for (const std::uint16_t ramp : {0x6048, 0x6049, 0x604A}) {
    EXPECT_EQ(pair.drive->object(ramp, 1), 10'000);
    EXPECT_EQ(pair.drive->object(ramp, 2), 2);
  }
  const double full = 1000.0 / 60.0 * static_cast<double>(kTurn);
  pair.spindle().velocity_counts_s = full;
  pair.run(1000);
  EXPECT_NEAR(pair.drive->velocity_counts_s(), full / 2.0, 0.05 * full) << "1000 rpm in 2 s";
}

TEST(Vl, with_another_factor_in_the_drive_is_refused_at_boot_with_both_numbers) {
  Inverter pair([](NodeConfig& node) {
    use_vl(node, 1);
    node.profile.settings.push_back({0x604C, 2, 4, 10});  // what somebody left in it
  });
  EXPECT_FALSE(pair.enabled());
  EXPECT_NE(pair.story.find("604Ch:02 vl dimension factor: expected 00000001h, got 0000000Ah"),
            std::string::npos)
      << pair.story;
}

TEST(ProfileTorque, is_led_with_its_slope_and_nothing_is_asked_in_another_mode) {
  Pair pair({}, [](NodeConfig& node) {
    node.profile.torque_mode = OperationMode::profile_torque;
    node.profile.modes |= supported_bit(OperationMode::profile_torque);
    node.profile.rpdo[0].mapping.add({0x6071, 0, 16});
    node.profile.tpdo[0].mapping.add({0x6077, 0, 16});
    node.setup.torque = NodeTorque{500, 900};
  });
  ASSERT_TRUE(pair.enable()) << pair.story;
  EXPECT_EQ(pair.drive->object(0x6087), 500);
  EXPECT_EQ(pair.drive->object(0x6080), 900);
  pair.control = [&] { pair.command().position_counts = pair.feedback().position_counts; };
  pair.command().torque_permille = 100.0;
  pair.run(100);
  EXPECT_EQ(pair.drive->object(0x6071), 0) << "in csp";
  pair.command().mode = image::DriveMode::cst;
  ASSERT_TRUE(pair.until([&] { return pair.feedback().mode == image::DriveMode::cst; }, 200)) << pair.story;
  EXPECT_EQ(pair.drive->object(0x6061), 4);
  EXPECT_EQ(pair.drive->object(0x6071), 100);
  pair.run(100);
  EXPECT_NEAR(pair.feedback().torque_permille, 50.0, 12.0) << "500 per mille a second";
  pair.run(200);
  EXPECT_NEAR(pair.feedback().torque_permille, 100.0, 5.0);
  pair.command().mode = image::DriveMode::csp;
  ASSERT_TRUE(pair.until([&] { return pair.feedback().mode == image::DriveMode::csp; }, 200)) << pair.story;
  EXPECT_EQ(pair.drive->object(0x6071), 0);
}

}  // namespace
}  // namespace servogate::canopen
