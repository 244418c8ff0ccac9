// SPDX-License-Identifier: Apache-2.0
// Drives that differ from CiA 402, each with the key of its device file that the gateway needs to know, and
// without: then it does not work, or the key would be for nothing.
#include <gtest/gtest.h>

#include "tests/canopen/master/pair.hpp"

namespace servogate::canopen {
namespace {

using image::DriveHoming;
using image::DriveMode;
using image::DriveState;

using testing::kTurn;
using testing::Pair;

NodeHoming by_method(std::int8_t method) {
  return {method, static_cast<std::uint32_t>(kTurn), static_cast<std::uint32_t>(kTurn / 10),
          static_cast<std::uint32_t>(10 * kTurn)};
}

bool fault_is_reset(bool told) {
  Pair pair({.fault_reset_level_ns = 100 * image::kMillisecond}, [told](NodeConfig& node) {
    if (told) node.profile.fault_reset = FaultReset::level;
  });
  EXPECT_TRUE(pair.enable()) << pair.story;
  fault::Fault fault;
  fault.kind = fault::Kind::over_current;
  pair.drive->inject(fault);
  EXPECT_TRUE(pair.until([&] { return pair.feedback().state == DriveState::fault; }));
  pair.drive->clear_faults();
  pair.command().power = false;
  pair.run(50);
  pair.command().reset_fault = true;
  return pair.until([&] { return pair.feedback().state == DriveState::switch_on_disabled; }, 1500);
}

TEST(Quirks, a_drive_that_resets_its_fault_by_the_level_needs_the_bit_held) {
  EXPECT_TRUE(fault_is_reset(true));
  EXPECT_FALSE(fault_is_reset(false));
}

bool boots(Pair& pair) {
  return pair.until([&] { return pair.feedback().online; }, 2000);
}

TEST(Quirks, method_0_is_written_where_the_drive_is_not_to_home_but_not_into_a_drive_without_it) {
  const auto not_to_home = [](NodeConfig& node) { node.setup.homing = NodeHoming{}; };
  Pair standard({}, not_to_home);
  ASSERT_TRUE(boots(standard)) << standard.story;
  Pair untold({.homing_method_none = false}, not_to_home);
  EXPECT_FALSE(boots(untold));
  EXPECT_NE(untold.story.find("homing by the drive"), std::string::npos) << untold.story;
  Pair told({.homing_method_none = false}, [&](NodeConfig& node) {
    not_to_home(node);
    node.profile.homing_method_none = false;
  });
  EXPECT_TRUE(boots(told)) << told.story;
}

TEST(Quirks, method_37_goes_to_the_drive_under_its_own_number) {
  const auto here = [](NodeConfig& node) { node.setup.homing = by_method(37); };
  Pair untold({.homing_method_here = -1}, here);
  EXPECT_FALSE(boots(untold));
  EXPECT_EQ(untold.story,
            "x: boot stopped at step \"homing by the drive\": reading 60E3h:00 Supported homing methods: 37 "
            "is none of "
            "the 32 that the device has\n");
  Pair told({.homing_method_here = -1}, [&](NodeConfig& node) {
    here(node);
    node.profile.homing_method_here = -1;
  });
  ASSERT_TRUE(boots(told)) << told.story;
  EXPECT_EQ(told.drive->object(0x6098), -1);
}

TEST(Quirks, an_empty_list_of_methods_refuses_the_drive_unless_its_file_says_not_to_look) {
  const auto by_zero_mark = [](NodeConfig& node) { node.setup.homing = by_method(33); };
  Pair untold({.homing_method_list = false}, by_zero_mark);
  EXPECT_FALSE(boots(untold));
  Pair told({.homing_method_list = false}, [&](NodeConfig& node) {
    by_zero_mark(node);
    node.profile.homing_method_list = false;
  });
  ASSERT_TRUE(boots(told)) << told.story;
  EXPECT_EQ(told.drive->object(0x6098), 33);
  EXPECT_EQ(told.drive->object(0x6099, 2), kTurn / 10);
  EXPECT_EQ(told.drive->object(0x609A), 10 * kTurn);
}

/// Way of the shaft from the halt on, in turns, and how the drive ended.
struct Halted {
  double way = 0.0;
  bool stands = false;
  DriveState state = DriveState::offline;
};
Halted halted(bool has_halt, bool told) {
  Pair pair({.halt = has_halt}, [told](NodeConfig& node) {
    node.setup.homing = by_method(17);  // no limit switch comes: it would search for ever
    node.profile.halt = told;
  });
  EXPECT_TRUE(pair.enable()) << pair.story;
  pair.command().mode = DriveMode::homing;
  EXPECT_TRUE(pair.until([&] { return pair.feedback().homing == DriveHoming::running; }));
  pair.run(500);
  const double before = pair.drive->revolutions();
  pair.command().halt = true;
  pair.run(5);
  if (!told) pair.command().power = false;  // as the axis does when the drive lets go
  pair.run(1500);
  return {std::abs(pair.drive->revolutions() - before), std::abs(pair.drive->velocity_counts_s()) < 100.0,
          pair.drive->state()};
}

TEST(Quirks, a_homing_is_stopped_by_the_halt_bit_or_by_the_quick_stop_of_a_drive_without_one) {
  const Halted standard = halted(true, true);
  EXPECT_TRUE(standard.stands);
  EXPECT_LT(standard.way, 0.1);
  EXPECT_EQ(standard.state, DriveState::operation_enabled);
  const Halted untold = halted(false, true);
  EXPECT_FALSE(untold.stands) << "it does not know the bit";
  const Halted by_quick_stop = halted(false, false);
  EXPECT_TRUE(by_quick_stop.stands);
  EXPECT_LT(by_quick_stop.way, 0.1) << "the ramp of the quick stop, though the power is taken away meanwhile";
  EXPECT_EQ(by_quick_stop.state, DriveState::switch_on_disabled);
}

void use_ip(NodeConfig& node) {
  node.profile.position_mode = OperationMode::interpolated_position;
  node.profile.modes = supported_bit(OperationMode::interpolated_position);
  node.profile.rpdo[0].mapping = {};
  node.profile.rpdo[0].mapping.add({0x6040, 0, 16});
  node.profile.rpdo[0].mapping.add({0x60C1, 1, 32});
}

/// Counts that the drive has moved when it was asked for 100 a cycle for a second.
std::int64_t moved_in_ip(bool told) {
  Pair pair({.velocity_in_ip_record = true}, [told](NodeConfig& node) {
    use_ip(node);
    if (!told) return;
    node.profile.ip_velocity_entry = 2;
    node.profile.rpdo[1].mapping.add({0x60C1, 2, 32});
  });
  EXPECT_TRUE(pair.enable()) << pair.story;
  const std::int64_t from = pair.feedback().position_counts;
  pair.control = [&, target = from]() mutable {
    pair.command().position_counts = target += 100;
    pair.command().velocity_counts_s = 100'000.0;
  };
  pair.run(1000);
  if (told) {
    EXPECT_EQ(pair.drive->object(0x60C1, 2), 100'000);
  }
  return pair.feedback().position_counts - from;
}

TEST(Quirks, a_record_of_position_and_velocity_is_filled_whole) {
  EXPECT_NEAR(static_cast<double>(moved_in_ip(true)), 100'000.0, 1'000.0);
  EXPECT_EQ(moved_in_ip(false), 0) << "no record is ever complete";
}

/// A drive that takes no part of a record of position alone is a drive that interpolates; one that never
/// shows bit 12 has bit 4 of the controlword taken away on its way.
TEST(Quirks, a_drive_that_never_begins_to_interpolate_is_named_once_with_what_was_awaited) {
  Pair pair({}, [](NodeConfig& node) { use_ip(node); });
  ASSERT_TRUE(pair.enable()) << pair.story;
  pair.run(50);
  EXPECT_EQ(pair.story, "");
  fault::Fault fault;
  fault.kind = fault::Kind::rpdo_corrupted;
  fault.value = 0x10;
  pair.drive->inject(fault);
  pair.run(400);
  EXPECT_EQ(pair.story, "") << "a transition may take 500 ms";
  pair.run(2000);
  EXPECT_EQ(
      pair.story,
      "x: in interpolated position mode bit 12 of the statusword (interpolation active) has not come for "
      "500 ms; statusword 0237h\n");
}

TEST(Quirks, a_drive_that_counts_60C2_in_tenths_of_a_millisecond_gets_it_so) {
  Pair untold({.interpolation_exponent = -4}, [](NodeConfig&) {});
  EXPECT_FALSE(boots(untold));
  EXPECT_NE(untold.story.find("interpolation time period"), std::string::npos) << untold.story;
  Pair told({.interpolation_exponent = -4}, [](NodeConfig& node) { node.profile.interpolation_base = -4; });
  ASSERT_TRUE(boots(told)) << told.story;
  EXPECT_EQ(told.drive->object(0x60C2, 1), 10);
}

TEST(Quirks, speeds_of_homing_go_in_the_drives_own_units_and_home_is_at_0_of_its_counting) {
  Pair pair({}, [](NodeConfig& node) { node.setup.homing = by_method(37); });
  ASSERT_TRUE(pair.enable()) << pair.story;
  pair.command().position_counts += 5'000;
  pair.run(500);
  pair.command().mode = DriveMode::homing;
  ASSERT_TRUE(pair.until([&] { return pair.feedback().homing == DriveHoming::attained; })) << pair.story;
  EXPECT_NEAR(static_cast<double>(pair.feedback().position_counts), 0.0, 20.0);
  EXPECT_EQ(pair.feedback().home_counts, 0);
}

/// A drive whose maps are these already, and that lets nobody change them.
std::function<void(mock::SimulatedDriveConfig&)> with_fixed_maps(MapAccess access, std::uint32_t target) {
  return [=](mock::SimulatedDriveConfig& plate) {
    mock::SimulatedDriveConfig::PdoMap to{false, 1, {}}, from{true, 1, {}};
    for (const std::uint32_t word : {0x6040'0010u, target}) to.mapping.add(MappingEntry::from_word(word));
    for (const std::uint32_t word : {0x6041'0010u, 0x6064'0020u})
      from.mapping.add(MappingEntry::from_word(word));
    plate.map_access = access;
    plate.maps = {to, from};
  };
}
constexpr std::uint32_t kTargetPosition = 0x607A'0020, kTargetVelocity = 0x60FF'0020;
void fixed(NodeConfig& node) { node.profile.pdo_map_fixed = true; }
void not_told(NodeConfig&) {}

TEST(Quirks, a_map_that_cannot_be_written_is_compared_where_the_file_says_so_and_the_drive_moves) {
  Pair told({}, fixed, with_fixed_maps(MapAccess::fixed, kTargetPosition));
  ASSERT_TRUE(told.enable()) << told.story;
  const std::int64_t start = told.feedback().position_counts;
  for (int i = 0; i < 200; ++i) {
    told.command().position_counts += 100;
    told.run(1);
  }
  told.run(20);
  EXPECT_NEAR(static_cast<double>(told.feedback().position_counts - start), 20'000.0, 20.0) << told.story;
}

TEST(Quirks, a_map_that_cannot_be_written_stops_the_boot_where_the_file_does_not_say_so) {
  Pair untold({}, not_told, with_fixed_maps(MapAccess::fixed, kTargetPosition));
  EXPECT_FALSE(boots(untold));
  EXPECT_NE(untold.story.find("writing 1600h:00"), std::string::npos) << untold.story;
  EXPECT_NE(untold.story.find("(06010002h)"), std::string::npos) << untold.story;
}

TEST(Quirks, a_fixed_map_that_is_another_one_is_named_with_both) {
  Pair told({}, fixed, with_fixed_maps(MapAccess::fixed, kTargetVelocity));
  EXPECT_FALSE(boots(told));
  for (const char* part : {"1600h:02", "expected 607A0020h", "got 60FF0020h"})
    EXPECT_NE(told.story.find(part), std::string::npos) << told.story;
}

TEST(Quirks, maps_that_are_switched_as_a_whole_take_their_own_entries_and_no_others) {
  Pair same({}, not_told, with_fixed_maps(MapAccess::whole, kTargetPosition));
  EXPECT_TRUE(boots(same)) << same.story;
  Pair other({}, not_told, with_fixed_maps(MapAccess::whole, kTargetVelocity));
  EXPECT_FALSE(boots(other));
  EXPECT_NE(other.story.find("writing 1600h:02"), std::string::npos) << other.story;
  EXPECT_NE(other.story.find("(06040041h)"), std::string::npos) << other.story;
}

}  // namespace
}  // namespace servogate::canopen
