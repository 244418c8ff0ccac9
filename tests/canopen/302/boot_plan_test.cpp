// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/boot_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace servogate::canopen {
namespace {

using Kind = BootAction::Kind;

NodeConfig position_node() {
  NodeConfig node;
  node.node = 5;
  use_short_position_map(node.profile);
  return node;
}

std::string words(const BootAction& action) {
  char text[64];
  std::snprintf(text, sizeof text, "%s %04X:%u %u %X", action.kind == Kind::write ? "write" : "read",
                action.index, action.subindex, action.bytes, action.value);
  return text;
}

std::vector<std::string> of_step(const std::vector<BootAction>& plan, BootStep step) {
  std::vector<std::string> out;
  for (const BootAction& action : plan)
    if (action.step == step) out.push_back(words(action));
  return out;
}

TEST(BootPlan, begins_with_reset_and_identity_and_ends_with_start) {
  const auto plan = boot_plan(position_node(), {});
  EXPECT_EQ(plan.front().kind, Kind::reset);
  EXPECT_EQ(plan[1].index, 0x1000);
  EXPECT_EQ(plan[2].index, 0x1018);
  EXPECT_EQ(plan.back().kind, Kind::start);
  EXPECT_TRUE(std::ranges::is_sorted(plan, {}, &BootAction::step));
  for (const BootAction& action : plan)
    if (action.kind == Kind::write) {
      EXPECT_GT(action.step, BootStep::identity) << "nothing is written to a stranger";
    }
}

TEST(BootPlan, switches_a_pdo_off_clears_maps_counts_and_switches_on_then_reads_back) {
  auto steps = of_step(boot_plan(position_node(), {}), BootStep::tpdo);
  const std::vector<std::string> expected = {
      "write 1800:1 4 C0000185", "write 1A00:0 1 0",        "write 1A00:1 4 60410010",
      "write 1A00:2 4 60640020", "write 1A00:0 1 2",        "write 1800:2 1 1",
      "read 1800:2 1 1",         "write 1800:1 4 40000185", "read 1A00:0 1 2",
      "read 1A00:1 4 60410010",  "read 1A00:2 4 60640020",  "read 1800:1 4 185",
      "write 1801:1 4 C0000285", "write 1802:1 4 C0000385", "write 1803:1 4 C0000485"};
  EXPECT_EQ(steps, expected);
}

TEST(BootPlan, writes_the_quick_stop_ramp_where_it_exists_and_lets_settings_and_a_configuration_overrule_it) {
  NodeConfig node = position_node();
  node.setup.quick_stop_ramp = 0x1234;
  node.profile.settings.push_back({0x6085, 0, 4, 0x99, true});
  const auto plan = boot_plan(node, {});
  const std::vector<std::string> expected = {"write 6085:0 4 1234", "read 6085:0 4 1234", "write 6085:0 4 99",
                                             "read 6085:0 4 99"};
  EXPECT_EQ(of_step(plan, BootStep::settings), expected);
  const auto first = std::ranges::find(plan, 0x6085, &BootAction::index);
  EXPECT_TRUE(first->optional) << "a drive without 6085h stays as it is";
  node.profile.settings.clear();
  node.setup.concise_dcf = {0, 0, 0, 0};
  EXPECT_TRUE(of_step(boot_plan(node, {}), BootStep::settings).empty());
}

TEST(BootPlan, unused_pdos_need_not_exist) {
  for (const BootAction& action : boot_plan(position_node(), {}))
    if (action.index == 0x1401 || action.index == 0x1803) {
      EXPECT_TRUE(action.optional);
    }
}

TEST(BootPlan, a_fixed_map_is_read_and_not_written) {
  NodeConfig node = position_node();
  node.profile.pdo_map_fixed = true;
  int reads = 0;
  for (const BootAction& action : boot_plan(node, {})) {
    if (action.index != 0x1600 && action.index != 0x1A00) continue;
    EXPECT_EQ(action.kind, Kind::read);
    ++reads;
  }
  EXPECT_EQ(reads, 6);
}

TEST(BootPlan, inhibit_and_event_times_are_written_where_asked_for) {
  NodeConfig node = position_node();
  node.profile.tpdo[0].transmission_type = 255;
  node.profile.tpdo[0].inhibit_100us = 20;
  node.profile.tpdo[0].event_ms = 50;
  node.profile.rpdo[0].event_ms = 10;
  const auto plan = boot_plan(node, {});
  const auto has = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    return std::ranges::any_of(plan, [&](const BootAction& a) {
      return a.kind == Kind::write && a.index == index && a.subindex == sub && a.value == value;
    });
  };
  EXPECT_TRUE(has(0x1800, 2, 255));
  EXPECT_TRUE(has(0x1800, 3, 20));
  EXPECT_TRUE(has(0x1800, 5, 50));
  EXPECT_TRUE(has(0x1400, 5, 10));
}

TEST(BootPlan, supervision_of_the_control_is_written_and_read_back) {
  SegmentConfig segment;
  segment.own_node = 127;
  segment.heartbeat_timeout_ms = 300;
  const auto plan = boot_plan(position_node(), segment);
  EXPECT_EQ(of_step(plan, BootStep::heartbeat_consumer),
            (std::vector<std::string>{"write 1016:1 4 7F012C", "read 1016:1 4 7F012C"}));
  EXPECT_EQ(of_step(plan, BootStep::abort_connection),
            (std::vector<std::string>{"write 6007:0 2 1", "read 6007:0 2 1"}));
  EXPECT_EQ(of_step(plan, BootStep::heartbeat_producer),
            (std::vector<std::string>{"write 1017:0 2 64", "read 1017:0 2 64"}));
}

TEST(BootPlan, what_a_drive_does_not_have_is_left_out) {
  NodeConfig node = position_node();
  node.profile.has_heartbeat_consumer = false;
  node.profile.abort_connection_option.reset();
  node.profile.interpolation_base.reset();
  node.profile.check_modes = false;
  for (const BootAction& action : boot_plan(node, {}))
    for (const std::uint16_t index : {0x1016, 0x6007, 0x60C2, 0x6502, 0x1006}) EXPECT_NE(action.index, index);
}

TEST(BootPlan, the_settings_of_the_device_file_come_before_the_pdos) {
  NodeConfig node = position_node();
  node.profile.settings = {{0x2310, 1, 2, 77, true}, {0x1010, 1, 4, 0x65766173, false}};
  EXPECT_EQ(of_step(boot_plan(node, {}), BootStep::settings),
            (std::vector<std::string>{"write 2310:1 2 4D", "read 2310:1 2 4D", "write 1010:1 4 65766173"}));
}

TEST(BootPlan, a_spindle_gets_its_velocity_mode) {
  NodeConfig node;
  node.target = DriveTarget::spindle;
  node.profile.velocity_mode = OperationMode::profile_velocity;
  use_velocity_map(node.profile);
  const auto plan = boot_plan(node, {});
  EXPECT_EQ(of_step(plan, BootStep::mode), std::vector<std::string>{"write 6060:0 1 3"});
  EXPECT_EQ(of_step(plan, BootStep::supported_modes), std::vector<std::string>{"read 6502:0 4 4"});
}

TEST(InterpolationTime, takes_the_base_of_the_drive_or_a_finer_one) {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
  ASSERT_TRUE(interpolation_time(1'000'000, -3, value, exponent));
  EXPECT_EQ(value, 1);
  EXPECT_EQ(exponent, -3);
  ASSERT_TRUE(interpolation_time(500'000, -3, value, exponent));
  EXPECT_EQ(value, 5);
  EXPECT_EQ(exponent, -4);
  ASSERT_TRUE(interpolation_time(4'000'000, -4, value, exponent));
  EXPECT_EQ(value, 40);
  EXPECT_EQ(exponent, -4);
  ASSERT_TRUE(interpolation_time(125'000, -3, value, exponent));
  EXPECT_EQ(value, 125);
  EXPECT_EQ(exponent, -6);
  EXPECT_FALSE(interpolation_time(100'000'000, -6, value, exponent)) << "100 000 µs do not fit into a byte";
  EXPECT_FALSE(interpolation_time(333'333, -3, value, exponent)) << "333 333 ns neither";
}

TEST(InterpolationTime, a_cycle_that_cannot_be_written_is_refused_at_configuration) {
  SegmentConfig segment;
  segment.cycle_ns = 333'333;
  EXPECT_THROW(boot_plan(position_node(), segment), std::invalid_argument);
}

}  // namespace
}  // namespace servogate::canopen
