// SPDX-License-Identifier: Apache-2.0
// Drives that form their motion by themselves: profile position by process data, and drives that only answer
// SDO.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware_if/canopen/master/sdo_budget.hpp"
#include "tests/canopen/master/pair.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::kTurn;
using testing::Pair;

constexpr std::uint32_t kSpeed = 4 * kTurn, kRamp = 40 * kTurn;

void use_pp(NodeConfig& node) {
  node.profile.position_mode = OperationMode::profile_position;
  node.profile.modes = supported_bit(OperationMode::profile_position);
  node.setup.profile_speed = kSpeed;
  node.setup.speed_ramp = kRamp;
}

void only_sdo(NodeConfig& node) {
  use_pp(node);
  node.profile.sdo_only = true;
  node.profile.rpdo = {};
  node.profile.tpdo = {};
}

void only_sdo_spindle(NodeConfig& node) {
  only_sdo(node);
  node.target = DriveTarget::spindle;
  node.profile.velocity_mode = OperationMode::profile_velocity;
  node.profile.modes = supported_bit(OperationMode::profile_velocity);
}

/// What of the wire is not of this: SYNC, NMT, heartbeats, boot.
struct Traffic {
  int pdos = 0;
  int set_points = 0;  ///< rises of bit 4 in controlwords, however they came
  int broken = 0;      ///< a target that changed while bit 4 stood
};

/// Moves at a tenth of full speed for a second. The greatest distance behind, in counts.
std::int64_t follow(Pair& pair, Traffic& traffic) {
  image::CanBus& listener = pair.wire.add_endpoint("listener");
  std::int64_t target = pair.feedback().position_counts, behind = 0;
  constexpr std::int64_t kStep = kSpeed / 10 / 1000;
  bool start = false;
  std::uint32_t shown = 0;
  pair.control = [&] {
    pair.command().position_counts = target += kStep;
    behind = std::max(behind, std::abs(target - pair.feedback().position_counts));
    image::CanFrame f;
    while (listener.receive(f)) {
      const CobId cob = classify(f.id, f.extended);
      const bool rpdo = cob.service == Service::rpdo1;
      traffic.pdos += rpdo || cob.service == Service::tpdo1;
      const bool sdo_write = cob.service == Service::sdo_request && f.data[0] >> 5 == 1;
      const int index = sdo_write ? f.data[1] | f.data[2] << 8 : 0;
      if (!rpdo && index != 0x6040 && index != 0x607A) continue;
      const std::size_t at = rpdo ? 2 : 4;
      const auto value = static_cast<std::uint32_t>(load_le(std::span(f.data).subspan(at, 4)));
      if (rpdo || index == 0x607A) {
        traffic.broken += start && value != shown;
        shown = value;
      }
      if (rpdo || index == 0x6040) {
        const bool now = (rpdo ? f.data[0] : f.data[4]) & 0x10;
        traffic.set_points += now && !start;
        start = now;
      }
    }
  };
  pair.run(1000);
  pair.control = [&] { pair.command().position_counts = target; };
  pair.run(500);
  EXPECT_NEAR(static_cast<double>(pair.feedback().position_counts), static_cast<double>(target), 30.0);
  return behind;
}

TEST(OwnMotion, in_profile_position_goes_from_set_point_to_set_point_by_the_handshake) {
  Pair pair({}, use_pp);
  ASSERT_TRUE(pair.enable()) << pair.story;
  EXPECT_EQ(pair.drive->object(0x6061), 1);
  EXPECT_EQ(pair.drive->object(0x6081), kSpeed);
  EXPECT_EQ(pair.drive->object(0x6083), kRamp);
  Traffic traffic;
  const double v = kSpeed / 10.0;
  EXPECT_LT(static_cast<double>(follow(pair, traffic)), v * v / (2.0 * kRamp) + 0.02 * v) << pair.story;
  EXPECT_GT(traffic.set_points, 100);
  EXPECT_EQ(traffic.broken, 0);
}

TEST(OwnMotion, of_a_drive_that_only_answers_sdo_needs_no_process_data) {
  Pair pair({}, only_sdo);
  ASSERT_TRUE(pair.enable()) << pair.story;
  Traffic traffic;
  const double v = kSpeed / 10.0,
               round_s =
                   1e-9 * static_cast<double>(sdo_round_ns(pair.config, pair.config.nodes[0], 1'000'000));
  EXPECT_LT(round_s, 0.02);
  EXPECT_LT(static_cast<double>(follow(pair, traffic)), v * v / (2.0 * kRamp) + 3.0 * v * round_s);
  EXPECT_EQ(traffic.pdos, 0);
  EXPECT_GT(traffic.set_points, static_cast<int>(0.5 / round_s)) << "about one a round";
  EXPECT_EQ(traffic.broken, 0);
  EXPECT_EQ(pair.story, "");
}

TEST(OwnMotion, stops_and_is_switched_off_by_sdo) {
  Pair pair({}, only_sdo);
  ASSERT_TRUE(pair.enable()) << pair.story;
  pair.command().power = false;
  EXPECT_TRUE(pair.until([&] { return pair.drive->state() == DriveState::switch_on_disabled; }, 100));
  ASSERT_TRUE(pair.enable());
  pair.command().quick_stop = true;
  EXPECT_TRUE(pair.until([&] { return pair.drive->state() != DriveState::operation_enabled; }, 10))
      << "a controlword does not wait for its turn";
}

TEST(OwnMotion, by_sdo_is_lost_when_no_answer_comes_in_time_and_back_when_one_comes) {
  Pair pair({}, [](NodeConfig& node) {
    only_sdo(node);
    node.setup.sdo_timeout_ms = 50;
  });
  ASSERT_TRUE(pair.enable()) << pair.story;
  fault::Fault fault;
  fault.kind = fault::Kind::sdo_silent;
  pair.drive->inject(fault);
  pair.run(45);
  EXPECT_TRUE(pair.feedback().online);
  pair.run(10);
  EXPECT_FALSE(pair.feedback().online);
  EXPECT_EQ(pair.story, "x: no process data (SDO) for 50 cycles\n");
  pair.run(500);
  EXPECT_FALSE(pair.feedback().online) << "asking again is no answer";
  pair.drive->clear_faults();
  pair.command().power = false;
  EXPECT_TRUE(pair.until([&] { return pair.feedback().online; }, 300));
  EXPECT_TRUE(pair.enable()) << pair.story;
}

TEST(OwnMotion, of_a_spindle_turns_at_a_speed_by_sdo) {
  Pair pair({}, only_sdo_spindle);
  auto& spindle = pair.image->spindles[0];
  spindle.drive_command.power = true;
  spindle.drive_command.mode = image::DriveMode::csv;
  spindle.drive_command.velocity_counts_s = 2.0 * kTurn;
  ASSERT_TRUE(pair.until([&] { return spindle.drive.state == DriveState::operation_enabled; })) << pair.story;
  pair.run(2000);
  EXPECT_NEAR(pair.drive->velocity_counts_s(), 2.0 * kTurn, 0.02 * kTurn);
  EXPECT_NEAR(spindle.drive.velocity_counts_s, 2.0 * kTurn, 0.05 * kTurn);
}

TEST(OwnMotion, by_sdo_takes_its_turns_with_other_drives_of_its_kind) {
  Pair pair({}, only_sdo);
  const auto round = [&] { return sdo_round_ns(pair.config, pair.config.nodes[0], 125'000); };
  const image::Nanoseconds alone = round();
  pair.config.nodes.push_back(pair.config.nodes[0]);
  pair.config.nodes.back().node = 2;
  EXPECT_GT(round(), alone) << "two share what a slow bus leaves";
}

TEST(OwnMotion, by_sdo_is_refused_for_a_mode_with_a_set_point_in_every_cycle) {
  for (const auto mode : {OperationMode::cyclic_sync_position, OperationMode::interpolated_position})
    EXPECT_THROW(Pair({},
                      [mode](NodeConfig& node) {
                        only_sdo(node);
                        node.profile.position_mode = mode;
                      }),
                 std::invalid_argument);
}

}  // namespace
}  // namespace servogate::canopen
