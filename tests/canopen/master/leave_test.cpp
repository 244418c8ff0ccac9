// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/canopen/master/pair.hpp"
#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using testing::SegmentRig;
using testing::show;

/// Everything that the master said while it took its leave.
std::vector<std::string> leave(SegmentRig& rig, int milliseconds = 200) {
  std::vector<std::string> said;
  bool done = false;
  for (int i = 0; i < milliseconds && !done; ++i) {
    done = rig.segment->leave(rig.image->now.t_ns);
    rig.image->now.t_ns += image::kMillisecond;
    rig.network.transfer(rig.image->now.t_ns);
    for (const image::CanFrame& f : rig.network.last_sent) said.push_back(show(f));
  }
  EXPECT_TRUE(done);
  return said;
}

int count(const std::vector<std::string>& said, const std::string& frame) {
  return static_cast<int>(std::count(said.begin(), said.end(), frame));
}

TEST(Leave, of_drives_without_torque_takes_their_watch_of_the_control_back) {
  SegmentRig rig(3);
  rig.start();
  ASSERT_TRUE(rig.boot());
  for (int i = 0; i < 3; ++i) ASSERT_NE(rig.device(i).get(0x1016, 1), 0u);
  const std::vector<std::string> said = leave(rig);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(rig.device(i).get(0x1016, 1), 0u);
    EXPECT_EQ(count(said, "000 80 0" + std::to_string(i + 1)), 1) << "Pre-operational, once";
  }
  EXPECT_EQ(count(said, "080"), 0) << "no SYNC, no process data any more";
}

TEST(Leave, leaves_a_drive_with_torque_to_its_own_reaction) {
  SegmentRig rig(2);
  rig.start();
  ASSERT_TRUE(rig.boot());
  ASSERT_TRUE(rig.enable());
  rig.control = [](image::ProcessImage& image) { image.axes[0].drive_command.power = false; };
  ASSERT_TRUE(rig.run_until([&] { return rig.drive(0).state != image::DriveState::operation_enabled; }));
  rig.run(5);
  const std::vector<std::string> said = leave(rig);
  EXPECT_EQ(rig.device(0).get(0x1016, 1), 0u);
  EXPECT_NE(rig.device(1).get(0x1016, 1), 0u);
  EXPECT_EQ(count(said, "000 80 02"), 0);
}

/// A simulated drive whose control takes its leave, or dies; a second later.
std::int64_t error_register_a_second_after(bool taken_leave, const std::function<void(NodeConfig&)>& told) {
  testing::Pair pair({}, told);
  EXPECT_TRUE(pair.until([&] { return pair.feedback().online; }));
  pair.run(300);
  for (int i = 0; i < 1000; ++i) {
    if (taken_leave && i < 200) pair.segment->leave(pair.image->now.t_ns);
    pair.image->now.t_ns += image::kMillisecond;
    pair.wire.advance_to(pair.image->now.t_ns);
  }
  return pair.drive->object(0x1001);
}

TEST(Leave, is_no_fault_to_the_drive_and_a_death_is) {
  const auto heartbeat = [](NodeConfig&) {};
  const auto guarding = [](NodeConfig& node) {
    node.profile.guard_time_ms = 20;
    node.profile.life_time_factor = 3;
  };
  EXPECT_EQ(error_register_a_second_after(true, heartbeat), 0);
  EXPECT_NE(error_register_a_second_after(false, heartbeat), 0);
  EXPECT_EQ(error_register_a_second_after(true, guarding), 0);
  EXPECT_NE(error_register_a_second_after(false, guarding), 0);
}

TEST(Leave, from_a_drive_that_does_not_answer_ends_with_the_last_repetition) {
  SegmentRig rig;
  rig.start();
  ASSERT_TRUE(rig.boot());
  rig.device().silent_sdo = true;
  leave(rig, 5000);
}

}  // namespace
}  // namespace servogate::canopen
