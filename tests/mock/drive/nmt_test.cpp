// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

using canopen::NmtState;

TEST(DriveNmt, the_boot_up_message_is_the_first_frame_after_power_on) {
  CanSegment segment;
  auto& master = segment.add_endpoint();
  SimulatedDriveConfig config;
  config.node_id = 9;
  config.boot_time_s = 0.05;
  SimulatedDrive drive(config);
  segment.attach(drive);
  segment.advance_to(49 * image::kMillisecond);
  CanFrame f;
  EXPECT_FALSE(master.receive(f));
  EXPECT_EQ(drive.nmt_state(), NmtState::boot_up);
  segment.advance_to(60 * image::kMillisecond);
  ASSERT_TRUE(master.receive(f));
  EXPECT_EQ(f.id, 0x709u);
  EXPECT_EQ(f.length, 1);
  EXPECT_EQ(f.data[0], 0x00);
  EXPECT_EQ(drive.nmt_state(), NmtState::pre_operational);
  EXPECT_FALSE(master.receive(f));
}

TEST(DriveNmt, every_command_leads_to_its_state_addressed_or_broadcast) {
  DriveBench b;
  for (const std::uint8_t node : {DriveBench::kNode, std::uint8_t{0}}) {
    b.nmt(0x01, node);
    EXPECT_EQ(b.drive.nmt_state(), NmtState::operational);
    b.nmt(0x80, node);
    EXPECT_EQ(b.drive.nmt_state(), NmtState::pre_operational);
    b.nmt(0x02, node);
    EXPECT_EQ(b.drive.nmt_state(), NmtState::stopped);
    b.nmt(0x01, node);
    EXPECT_EQ(b.drive.nmt_state(), NmtState::operational);
    for (const std::uint8_t reset : {0x81, 0x82}) {
      b.seen.clear();
      b.nmt(reset, node);
      b.run(20);
      EXPECT_EQ(b.drive.nmt_state(), NmtState::pre_operational);
      const auto boot = b.take(0x705);
      ASSERT_TRUE(boot);
      EXPECT_EQ(boot->data[0], 0);
    }
  }
}

TEST(DriveNmt, commands_for_others_and_malformed_ones_are_ignored) {
  DriveBench b;
  b.nmt(0x01, 6);
  b.send(0x000, {0x01});
  b.send(0x000, {0x33, 0x05});
  b.run(2);
  EXPECT_EQ(b.drive.nmt_state(), NmtState::pre_operational);
}

TEST(DriveNmt, the_heartbeat_comes_at_its_period_with_the_state_in_it) {
  DriveBench b;
  b.write(0x1017, 0, 50, 2);
  b.seen.clear();
  b.run(500);
  EXPECT_NEAR(b.count(0x705), 10, 1);
  EXPECT_EQ(b.take(0x705)->data[0], 0x7F);
  b.nmt(0x01);
  b.seen.clear();
  b.run(60);
  EXPECT_EQ(b.take(0x705)->data[0], 0x05);
  b.nmt(0x02);
  b.seen.clear();
  b.run(60);
  EXPECT_EQ(b.take(0x705)->data[0], 0x04);
}

TEST(DriveNmt, node_guarding_is_answered_with_state_and_toggle_bit) {
  DriveBench b;
  CanFrame request;
  request.id = 0x705;
  request.remote = true;
  request.length = 1;
  for (const int expected : {0x7F, 0xFF, 0x7F}) {
    b.master.send(request);
    b.run(2);
    const auto answer = b.take(0x705);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->data[0], expected);
  }
}

TEST(DriveNmt, a_guarding_master_that_falls_silent_is_a_lost_connection) {
  DriveBench b;
  b.write(0x100C, 0, 10, 2);
  b.write(0x100D, 0, 3, 1);
  CanFrame request;
  request.id = 0x705;
  request.remote = true;
  for (int i = 0; i < 5; ++i) {
    b.master.send(request);
    b.run(20);
  }
  EXPECT_EQ(b.count(0x085), 0);
  b.run(20);
  EXPECT_EQ(b.count(0x085), 1);
}

struct DriveHeartbeatConsumer : testing::Test {
  DriveBench b;
  void SetUp() override {
    b.write(0x1016, 1, 0x007F0032, 4);  // node 127, 50 ms
    b.enable();
    b.nmt(0x01);
    ASSERT_EQ(b.drive.state(), image::DriveState::operation_enabled);
    b.seen.clear();
  }
  void beat(int n) {
    for (int i = 0; i < n; ++i) {
      b.send(0x77F, {0x05});
      b.run(20);
    }
  }
};

TEST_F(DriveHeartbeatConsumer, emcy_is_kept_back_in_stopped) {
  b.nmt(0x02);
  b.run(500);
  EXPECT_EQ(b.count(0x085), 0) << "not even of the stop itself (CiA 301, table 39)";
  EXPECT_EQ(b.drive.state(), image::DriveState::fault) << "6007h = 1";
  b.nmt(0x80);
  b.run(5);
  EXPECT_GE(b.count(0x085), 1) << "what has happened meanwhile is told";
}

TEST_F(DriveHeartbeatConsumer, watching_begins_with_the_first_heartbeat) {
  b.run(500);
  EXPECT_EQ(b.count(0x085), 0);
  EXPECT_EQ(b.drive.state(), image::DriveState::operation_enabled);
}

TEST_F(DriveHeartbeatConsumer, a_lost_heartbeat_gives_emcy_8130_the_fault_and_pre_operational) {
  beat(10);
  EXPECT_EQ(b.count(0x085), 0);
  b.run(32);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8130);
  EXPECT_EQ(emcy->data[2], 0x11) << "generic and communication";
  b.run(200);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault);
  EXPECT_EQ(b.drive.error_code(), 0x8130);
  EXPECT_EQ(b.drive.nmt_state(), NmtState::pre_operational) << "1029h:01 = 0";
  EXPECT_EQ(b.read(0x1001), 0x11u);
  EXPECT_EQ(b.read(0x1003, 0), 1u);
  EXPECT_EQ(b.read(0x1003, 1) & 0xFFFF, 0x8130u);
}

TEST_F(DriveHeartbeatConsumer, a_heartbeat_that_returns_clears_the_register_with_emcy_0000) {
  beat(3);
  b.run(60);
  b.seen.clear();
  beat(3);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x0000);
  EXPECT_EQ(b.read(0x1001), 0u);
}

TEST_F(DriveHeartbeatConsumer, option_6007_decides_what_the_drive_does) {
  b.write(0x6007, 0, 0, 2);
  beat(3);
  b.run(200);
  EXPECT_EQ(b.drive.state(), image::DriveState::operation_enabled);
  b.write(0x6007, 0, 2, 2);
  beat(3);
  b.run(200);
  EXPECT_EQ(b.drive.state(), image::DriveState::switch_on_disabled);
}

TEST_F(DriveHeartbeatConsumer, option_3_is_a_quick_stop_after_605A) {
  b.write(0x6007, 0, 3, 2);
  b.write(0x605A, 0, 6, 2);
  beat(3);
  b.run(200);
  EXPECT_EQ(b.drive.state(), image::DriveState::quick_stop_active);
}

TEST_F(DriveHeartbeatConsumer, error_behaviour_1029_keeps_or_stops_the_node) {
  b.write(0x1029, 1, 1, 1);
  beat(2);
  b.run(60);
  EXPECT_EQ(b.drive.nmt_state(), NmtState::operational);
  b.write(0x1029, 1, 2, 1);
  beat(2);
  b.run(60);
  EXPECT_EQ(b.drive.nmt_state(), NmtState::stopped);
}

TEST_F(DriveHeartbeatConsumer, one_node_cannot_be_watched_twice) {
  EXPECT_EQ(b.write(0x1016, 2, 0x007F0064, 4), 0x06040043u);
  EXPECT_EQ(b.write(0x1016, 2, 0x007E0064, 4), 0u);
}

TEST(DriveEmcy, the_history_holds_the_newest_first_and_is_cleared_by_writing_0) {
  DriveBench b;
  for (const int code : {0x1111, 0x2222, 0x3333})
    b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = static_cast<std::uint16_t>(code)});
  EXPECT_EQ(b.read(0x1003, 0), 3u);
  EXPECT_EQ(b.read(0x1003, 1) & 0xFFFF, 0x3333u);
  EXPECT_EQ(b.read(0x1003, 3) & 0xFFFF, 0x1111u);
  EXPECT_EQ(b.write(0x1003, 0, 0, 1), 0u);
  EXPECT_EQ(b.read(0x1003, 0), 0u);
  for (int i = 0; i < 12; ++i) b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = 0x1234});
  EXPECT_EQ(b.read(0x1003, 0), 8u) << "the oldest fall out";
}

TEST(DriveEmcy, the_history_takes_no_value_but_0_and_has_no_entries_beyond_its_count) {
  DriveBench b;
  b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = 0x1111});
  EXPECT_EQ(b.write(0x1003, 0, 1, 1), 0x06090030u);
  EXPECT_EQ(b.write(0x1003, 0, 255, 1), 0x06090030u);
  EXPECT_EQ(b.write(0x1003, 1, 0, 4), 0x06010002u) << "an entry is read only";
  EXPECT_EQ(b.read(0x1003, 0), 1u) << "nothing was cleared";
  EXPECT_EQ(b.write(0x1003, 0, 0, 1), 0u);
  EXPECT_EQ(b.read(0x1003, 1), 0x08000024u) << "no data available";
  EXPECT_EQ(b.read(0x1003, 9), 0x06090011u);
}

TEST(DriveEmcy, the_history_is_no_parameter_that_could_be_stored) {
  DriveBench b;
  for (int i = 0; i < 3; ++i) b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = 0x2222});
  ASSERT_EQ(b.write(0x1010, 1, 0x65766173, 4), 0u);
  b.nmt(0x82);
  b.run(20);
  EXPECT_EQ(b.read(0x1003, 0), 0u) << "errors that never were";
}

TEST(DriveEmcy, each_group_of_error_codes_has_its_bit_of_the_register) {
  for (const auto& [code, bits] : {std::pair{0x1000, 0x01},
                                   {0x2340, 0x03},
                                   {0x3110, 0x05},
                                   {0x4210, 0x09},
                                   {0x8110, 0x11},
                                   {0x8210, 0x11},
                                   {0x8500, 0x21},
                                   {0x9000, 0x01},
                                   {0xFF12, 0x81}}) {
    DriveBench b;
    b.drive.inject({.kind = fault::Kind::emcy, .error_code = static_cast<std::uint16_t>(code)});
    b.run(5);
    EXPECT_EQ(b.read(0x1001), static_cast<std::uint32_t>(bits)) << std::hex << code;
    b.control(0x80);
    EXPECT_EQ(b.read(0x1001), 0u) << std::hex << code;
  }
}

TEST(DriveEmcy, sync_time_and_emcy_take_no_restricted_identifier) {
  DriveBench b;
  ASSERT_EQ(b.write(0x1014, 0, 0x80000085, 4), 0u);
  for (const std::uint32_t id : {0x000u, 0x07Fu, 0x101u, 0x180u, 0x581u, 0x601u, 0x6E0u, 0x705u}) {
    EXPECT_EQ(b.write(0x1005, 0, id, 4), 0x06090030u) << std::hex << id;
    EXPECT_EQ(b.write(0x1012, 0, 0x80000000 | id, 4), 0x06090030u) << std::hex << id;
    EXPECT_EQ(b.write(0x1014, 0, id, 4), 0x06090030u) << std::hex << id;
  }
  EXPECT_EQ(b.write(0x1005, 0, 0x081, 4), 0u);
  EXPECT_EQ(b.write(0x1012, 0, 0x80000100, 4), 0u);
  EXPECT_EQ(b.write(0x1014, 0, 0x085, 4), 0u);
}

TEST(DriveEmcy, the_identifier_1014_can_be_switched_off_and_the_inhibit_time_spreads_messages) {
  DriveBench b;
  b.write(0x1015, 0, 200, 2);  // 20 ms
  b.seen.clear();
  for (int i = 0; i < 3; ++i) b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = 0xFF00});
  b.run(10);
  EXPECT_EQ(b.count(0x085), 1);
  b.run(20);
  EXPECT_EQ(b.count(0x085), 2);
  b.run(20);
  EXPECT_EQ(b.count(0x085), 3);
  EXPECT_EQ(b.write(0x1014, 0, 0x80000085, 4), 0u);
  b.seen.clear();
  b.drive.inject({.kind = fault::Kind::emcy_only});
  b.run(30);
  EXPECT_EQ(b.count(0x085), 0);
}

}  // namespace
}  // namespace servogate::mock
