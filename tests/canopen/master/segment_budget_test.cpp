// SPDX-License-Identifier: Apache-2.0
// What service data may take of the bus, and what each node has of its own.
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/master/segment_load.hpp"
#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using testing::SegmentRig;

bool wrote(const testing::FakeDrive& drive, const std::string& write) {
  return std::find(drive.writes.begin(), drive.writes.end(), write) != drive.writes.end();
}

TEST(SegmentBudget, each_node_has_a_heartbeat_of_its_own) {
  SegmentRig rig(3);
  rig.config.nodes[0].heartbeat_ms = 50;
  rig.config.nodes[1].heartbeat_ms = 400;
  rig.start();
  ASSERT_TRUE(rig.boot());
  EXPECT_TRUE(wrote(rig.device(0), "1017:0=32"));
  EXPECT_TRUE(wrote(rig.device(1), "1017:0=190"));
  EXPECT_TRUE(wrote(rig.device(2), "1017:0=64")) << "the segment's";
  rig.run(500);
  EXPECT_EQ(rig.count(BusEventKind::heartbeat_lost), 0);
  rig.device(0).silent_heartbeat = rig.device(1).silent_heartbeat = true;
  ASSERT_TRUE(rig.run_until([&] { return rig.count(BusEventKind::heartbeat_lost) == 1; }, 200));
  EXPECT_EQ(rig.last(BusEventKind::heartbeat_lost)->node, 1);
  EXPECT_EQ(rig.last(BusEventKind::heartbeat_lost)->got, 151);
  EXPECT_TRUE(rig.drive(1).online);
  ASSERT_TRUE(rig.run_until([&] { return !rig.drive(1).online; }, 1300));
  EXPECT_EQ(rig.last(BusEventKind::heartbeat_lost)->got, 1201);
}

TEST(SegmentBudget, each_node_has_a_patience_of_its_own_for_process_data) {
  SegmentRig rig(2);
  rig.config.nodes[0].max_missed_pdo = 2;
  rig.config.nodes[1].max_missed_pdo = 40;
  rig.start();
  ASSERT_TRUE(rig.boot());
  rig.run(10);
  rig.device(0).silent_tpdo = rig.device(1).silent_tpdo = true;
  rig.run(10);
  EXPECT_FALSE(rig.drive(0).online);
  EXPECT_TRUE(rig.drive(1).online);
  rig.run(40);
  EXPECT_FALSE(rig.drive(1).online);
}

/// Requests of service data that the master sends in `cycles` while every drive is asked without end.
int requests(SegmentRig& rig, int cycles) {
  int count = 0;
  for (int n = 0; n < cycles; ++n) {
    rig.step();
    for (const image::CanFrame& f : rig.network.last_sent) count += f.id > 0x600 && f.id <= 0x67F;
  }
  return count;
}

TEST(SegmentBudget, service_data_take_what_planned_load_and_reserve_leave) {
  for (const int axes : {1, 2, 3, 4}) {
    SegmentRig rig(axes);
    rig.config.sdo_frames_per_cycle = 100;
    rig.start();
    ASSERT_TRUE(rig.boot());
    ASSERT_TRUE(rig.enable());
    for (int a = 0; a < axes; ++a) rig.command(a).latch_arm = true;  // its status is polled for ever
    rig.run(100);
    const double load = segment_load(1'000'000, rig.config.cycle_ns, rig.config.nodes).load;
    const double exchange = 2.0 * image::worst_case_bits(8);
    const double bits = std::max((1.0 - load - 0.05) * 1000.0, exchange / 20.0);
    const int sent = requests(rig, 2000);
    // A drive answers at most one question a cycle, which is the other bound.
    EXPECT_LE(sent, 2000 * bits / exchange + 2) << axes << " axes, planned " << load;
    EXPECT_GE(sent, 0.4 * std::min(2000.0 * axes, 2000 * bits / exchange)) << axes << " axes";
  }
}

/// The wire of the examples: 1 Mbit/s, 1 ms, three drives, 75 % planned.
TEST(SegmentBudget, a_full_bus_keeps_its_heartbeats_while_service_data_are_asked_for_without_end) {
  mock::CanSegment wire;
  image::CanBus& bus = wire.add_endpoint("master");
  SegmentConfig config;
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives;
  for (int i = 0; i < 3; ++i) {
    NodeConfig node = SegmentRig::axis_node(static_cast<NodeId>(i + 1), i);
    node.profile.counts_per_rev = 262'144;
    config.nodes.push_back(node);
    mock::SimulatedDriveConfig drive;
    drive.node_id = node.node;
    drive.plant.counts_per_rev = 262'144;
    drives.push_back(std::make_unique<mock::SimulatedDrive>(drive));
    wire.attach(*drives.back());
  }
  ASSERT_GT(segment_load(1'000'000, config.cycle_ns, config.nodes).load, 0.7);
  Segment segment(bus, config);
  const auto image = std::make_unique<image::ProcessImage>();
  int lost = 0;
  for (int n = 0; n < 10'000; ++n) {
    wire.advance_to(image->now.t_ns);
    segment.open_cycle(*image);
    segment.receive(*image);
    for (int a = 0; a < 3; ++a) {
      auto& axis = image->axes[static_cast<std::size_t>(a)];
      axis.drive_command.power = true;
      // The zero mark never comes: its status is asked for without end, from the beginning.
      axis.drive_command.latch_arm = true;
      axis.drive_command.position_counts = axis.drive.position_counts;
    }
    segment.send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    BusEvent e;
    while (segment.events().pop(e)) lost += e.kind == BusEventKind::heartbeat_lost;
  }
  EXPECT_EQ(lost, 0);
  for (int a = 0; a < 3; ++a)
    EXPECT_EQ(image->axes[static_cast<std::size_t>(a)].drive.state, image::DriveState::operation_enabled)
        << "a probe that waits for its mark must not keep the mode from being read";
}

}  // namespace
}  // namespace servogate::canopen
