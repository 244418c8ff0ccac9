// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::frame;
using testing::SegmentRig;

struct RunningRig : ::testing::Test {
  RunningRig() : rig(2) {
    rig.start();
    ready = rig.boot() && rig.enable();
    rig.events.clear();
  }
  SegmentRig rig;
  bool ready = false;
};

TEST_F(RunningRig, a_silent_heartbeat_takes_the_node_offline_and_says_for_how_long) {
  ASSERT_TRUE(ready);
  rig.device().silent_heartbeat = true;
  ASSERT_TRUE(rig.run_until([&] { return !rig.drive().online; }, 400));
  EXPECT_EQ(rig.drive().state, DriveState::offline);
  EXPECT_TRUE(rig.drive(1).online) << "the other one goes on";
  ASSERT_EQ(rig.count(BusEventKind::heartbeat_lost), 1);
  EXPECT_EQ(rig.last(BusEventKind::heartbeat_lost)->node, 1);
  EXPECT_EQ(rig.sentence(BusEventKind::heartbeat_lost), "X: no heartbeat for 301 ms");
  rig.run(1000);
  EXPECT_EQ(rig.count(BusEventKind::heartbeat_lost), 1);
  EXPECT_FALSE(rig.image->segments[0].operational);
}

TEST_F(RunningRig, a_drive_that_comes_back_boots_but_stays_off_until_power_is_withdrawn_once) {
  ASSERT_TRUE(ready);
  rig.device().powered = false;
  ASSERT_TRUE(rig.run_until([&] { return !rig.drive().online; }, 400));
  rig.device().power_on(rig.network.waiting_out);
  rig.network.flush_out();
  ASSERT_TRUE(rig.run_until([&] { return rig.drive().online; }, 2000));
  EXPECT_EQ(rig.count(BusEventKind::node_booted), 1);
  rig.run(500);
  EXPECT_EQ(rig.drive().state, DriveState::switch_on_disabled);
  rig.control = nullptr;
  rig.command().power = false;
  rig.run(2);
  EXPECT_TRUE(rig.enable());
}

TEST_F(RunningRig, a_restart_of_a_drive_is_said_and_it_is_configured_anew) {
  ASSERT_TRUE(ready);
  rig.device().set(0x1600, 0, 1, 0);
  rig.device().power_on(rig.network.waiting_out);
  rig.network.flush_out();
  rig.step();
  EXPECT_FALSE(rig.drive().online);
  EXPECT_EQ(rig.count(BusEventKind::node_restarted), 1);
  ASSERT_TRUE(rig.run_until([&] { return rig.drive().online; }, 2000));
  EXPECT_EQ(rig.device().get(0x1600, 0), 2u);
}

TEST_F(RunningRig, missing_process_data_is_counted_and_said_after_the_limit) {
  ASSERT_TRUE(ready);
  rig.device().silent_tpdo = true;
  rig.run(2);
  EXPECT_EQ(rig.drive().missed, 1u);
  EXPECT_TRUE(rig.drive().online);
  rig.run(1);
  EXPECT_EQ(rig.drive().missed, 2u);
  EXPECT_TRUE(rig.drive().online);
  rig.run(1);
  EXPECT_EQ(rig.drive().missed, 3u);
  EXPECT_FALSE(rig.drive().online);
  EXPECT_EQ(rig.sentence(BusEventKind::pdo_missing), "X: no process data (TPDO1) for 3 cycles");
  rig.run(100);
  EXPECT_EQ(rig.count(BusEventKind::pdo_missing), 1);
  EXPECT_EQ(rig.device().machine.state, DriveState::quick_stop_active)
      << "a drive that cannot be seen ramps down by itself";
  rig.device().silent_tpdo = false;
  rig.run(2);
  EXPECT_TRUE(rig.drive().online);
}

TEST_F(RunningRig, one_lost_pdo_is_no_loss) {
  ASSERT_TRUE(ready);
  int lost = 0;
  rig.network.fate = [&](const image::CanFrame& f) { return f.id == 0x181 && ++lost % 3 == 0 ? 0 : 1; };
  rig.run(1000);
  EXPECT_TRUE(rig.drive().online);
  EXPECT_EQ(rig.count(BusEventKind::pdo_missing), 0);
  EXPECT_EQ(rig.drive().state, DriveState::operation_enabled);
}

TEST(ProcessData, of_each_kind_that_has_to_come_is_missed_by_itself) {
  struct Kind {
    int number;
    std::uint8_t every;  ///< SYNCs
  };
  for (const Kind& kind : {Kind{1, 1}, {2, 1}, {3, 1}, {3, 10}}) {
    SegmentRig rig;
    DriveProfile& profile = rig.config.nodes[0].profile;
    use_full_position_map(profile);
    profile.tpdo[static_cast<std::size_t>(kind.number - 1)].transmission_type = kind.every;
    rig.start();
    ASSERT_TRUE(rig.boot());
    rig.run(40);
    ASSERT_TRUE(rig.drive().online);
    rig.network.fate = [&](const image::CanFrame& f) {
      return f.id == 0x81u + 0x100u * static_cast<unsigned>(kind.number) ? 0 : 1;
    };
    ASSERT_TRUE(rig.run_until([&] { return !rig.drive().online; }, 3 * kind.every + kind.every + 1))
        << kind.number;
    EXPECT_EQ(rig.count(BusEventKind::pdo_missing), 1);
    EXPECT_EQ(rig.sentence(BusEventKind::pdo_missing), "X: no process data (TPDO" +
                                                           std::to_string(kind.number) + ") for " +
                                                           std::to_string(3 * kind.every) + " cycles");
    rig.network.fate = nullptr;
    EXPECT_TRUE(rig.run_until([&] { return rig.drive().online; }, 20));
  }
}

TEST_F(RunningRig, a_short_pdo_is_not_used_and_is_said) {
  ASSERT_TRUE(ready);
  const auto position = rig.drive().position_counts;
  rig.device().short_tpdo = 2;
  rig.run(3);
  EXPECT_EQ(rig.drive().position_counts, position);
  EXPECT_GE(rig.drive().missed, 1u);
  EXPECT_EQ(rig.count(BusEventKind::pdo_short), 1) << "once, not in every cycle";
  EXPECT_EQ(rig.sentence(BusEventKind::pdo_short), "X: process data 181h has 4 bytes where 6 are mapped");
}

TEST_F(RunningRig, a_node_that_leaves_operational_is_said) {
  ASSERT_TRUE(ready);
  rig.device().nmt_state = 4;
  rig.device().silent_tpdo = true;
  ASSERT_TRUE(rig.run_until([&] { return rig.count(BusEventKind::node_left) == 1; }, 150));
  EXPECT_EQ(rig.sentence(BusEventKind::node_left), "X: has left state Operational, NMT state is now Stopped");
  EXPECT_FALSE(rig.drive().online);
}

TEST_F(RunningRig, a_node_nobody_declared_is_named_once) {
  ASSERT_TRUE(ready);
  for (int i = 0; i < 10; ++i) {
    rig.network.waiting.push_back(frame(0x740, {0x7F}));
    rig.step();
  }
  ASSERT_EQ(rig.count(BusEventKind::unknown_node), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::unknown_node), "X: node 64 is on the bus but not in the machine file");
}

TEST_F(RunningRig, a_full_queue_is_said_once_a_second_with_the_number_of_frames) {
  ASSERT_TRUE(ready);
  rig.network.refuse_sending = true;
  rig.run(500);
  ASSERT_EQ(rig.count(BusEventKind::send_failed), 1);
  EXPECT_EQ(rig.last(BusEventKind::send_failed)->got, 1);
  rig.run(600);
  ASSERT_EQ(rig.count(BusEventKind::send_failed), 2);
  EXPECT_GT(rig.last(BusEventKind::send_failed)->got, 1000);
}

TEST_F(RunningRig, bus_off_is_said_and_nothing_else_of_it) {
  ASSERT_TRUE(ready);
  rig.network.bus_state = image::CanState::bus_off;
  rig.network.refuse_sending = true;
  rig.run(500);
  EXPECT_EQ(rig.count(BusEventKind::bus_state), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::bus_state),
            "X: CAN controller is now bus off: nothing can be sent or received");
  EXPECT_EQ(rig.count(BusEventKind::send_failed), 0) << "the bus is off: no full queue";
  EXPECT_FALSE(rig.drive().online);
  EXPECT_FALSE(rig.drive(1).online);
  EXPECT_GT(rig.image->segments[0].errors, 500u);
  rig.network.bus_state = image::CanState::error_active;
  rig.network.refuse_sending = false;
  EXPECT_TRUE(rig.run_until([&] { return rig.drive().online && rig.drive(1).online; }, 5000));
}

TEST_F(RunningRig, a_bus_that_goes_down_while_set_points_are_sent_is_no_full_queue) {
  ASSERT_TRUE(ready);
  rig.control = [&](image::ProcessImage&) {
    rig.network.bus_state = image::CanState::down;
    rig.network.refuse_sending = true;
  };
  rig.run(5);
  EXPECT_EQ(rig.count(BusEventKind::send_failed), 0);
  EXPECT_EQ(rig.count(BusEventKind::bus_state), 1);
}

TEST_F(RunningRig, a_refused_transition_is_an_event_with_the_statusword_in_words) {
  ASSERT_TRUE(ready);
  rig.control = nullptr;
  rig.command().power = false;
  rig.run(20);
  rig.device().machine.refuses = DriveState::switched_on;
  rig.command().power = true;
  rig.run(2100);
  ASSERT_EQ(rig.count(BusEventKind::refused), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::refused),
            "X: the drive stays in \"Ready to switch on\" and does not go to \"Switched on\" for 2000 ms; "
            "statusword "
            "0231h: Ready to switch on");
  EXPECT_EQ(rig.drive().refusal.from, DriveState::ready_to_switch_on);
  EXPECT_EQ(
      rig.sentence(BusEventKind::refused, text::Language::russian),
      "X: привод остаётся в состоянии «Готов к включению» и не переходит в «Включён» уже 2000 мс; слово "
      "состояния 0231h: Готов к включению");
}

TEST_F(RunningRig, quick_stop_and_power_off_follow_the_command) {
  ASSERT_TRUE(ready);
  rig.control = nullptr;
  rig.command().quick_stop = true;
  rig.run(5);
  EXPECT_EQ(rig.drive().state, DriveState::quick_stop_active);
  rig.command().power = false;
  rig.run(5);
  EXPECT_EQ(rig.drive().state, DriveState::switch_on_disabled) << "power withdrawn goes before quick stop";
  rig.command().quick_stop = false;
  rig.run(5);
  EXPECT_EQ(rig.drive().state, DriveState::switch_on_disabled);
}

TEST(SegmentBoot, a_missing_node_is_said_after_its_attempts_and_found_when_it_appears) {
  SegmentRig rig;
  rig.start();
  rig.device().powered = false;
  rig.run(8000);
  ASSERT_EQ(rig.count(BusEventKind::boot_failed), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::boot_failed),
            "X: boot stopped at step \"reset of communication and boot-up message\": the expected message "
            "did not come");
  rig.run(10'000);
  EXPECT_EQ(rig.count(BusEventKind::boot_failed), 1) << "not again and again";
  rig.device().powered = true;
  EXPECT_TRUE(rig.boot());
}

TEST(SegmentBoot, a_wrong_drive_is_said_at_once_and_left_alone_until_it_is_replaced) {
  SegmentRig rig;
  rig.config.nodes[0].profile.vendor_id = 0x99;
  rig.start();
  rig.run(3000);
  ASSERT_EQ(rig.count(BusEventKind::boot_failed), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::boot_failed),
            "X: boot stopped at step \"identity\": reading 1018h:01 Identity object: expected 00000099h, got "
            "00000011h");
  EXPECT_TRUE(rig.device().writes.empty());
  rig.device().set(0x1018, 1, 4, 0x99);
  rig.device().power_on(rig.network.waiting_out);
  rig.network.flush_out();
  EXPECT_TRUE(rig.boot());
}

TEST(SegmentOnABadWire, comes_up_and_keeps_its_drives_whatever_is_lost_doubled_or_shuffled) {
  constexpr unsigned kSeed = 1898;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    SegmentRig rig(3);
    rig.config.sdo_timeout_ms = 20;
    rig.config.boot_pause_ms = 10;
    rig.start();
    // Three of a kind in a row would be a loss.
    std::map<std::uint32_t, int> lost;
    rig.network.fate = [&](const image::CanFrame& f) {
      const auto n = random() % 100;
      int& in_a_row = lost[f.id];
      in_a_row = n == 0 ? in_a_row + 1 : 0;
      if (n == 0 && in_a_row < 3) return 0;
      return n == 1 ? 2 : 1;
    };
    ASSERT_TRUE(rig.run_until([&] { return rig.image->segments[0].operational; }, 30'000));
    ASSERT_TRUE(rig.enable());
    rig.run(1000);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_TRUE(rig.drive(axis).online);
      EXPECT_EQ(rig.drive(axis).state, DriveState::operation_enabled);
      for (const std::int64_t target : rig.device(axis).applied) ASSERT_EQ(target, 0);
    }
  }
}

TEST(SegmentOnABadWire, survives_any_frames) {
  constexpr unsigned kSeed = 77;
  std::mt19937 random(kSeed);
  SegmentRig rig(3);
  rig.start();
  for (int i = 0; i < 20'000; ++i) {
    for (int n = 0; n < 5; ++n) {
      image::CanFrame f;
      f.id = random() % 0x800;
      if (random() % 2) f.id = (f.id & 0x780) | (1 + random() % 3);
      f.length = static_cast<std::uint8_t>(random() % 9);
      f.remote = random() % 20 == 0;
      f.extended = random() % 20 == 0;
      f.error = random() % 20 == 0;
      for (auto& byte : f.data) byte = static_cast<std::uint8_t>(random());
      rig.network.waiting.push_back(f);
    }
    rig.command(static_cast<int>(random() % 3)).power = random() % 2;
    rig.step();
    rig.events.clear();
  }
  EXPECT_GT(rig.image->segments[0].frames_received, 90'000u);
}

}  // namespace
}  // namespace servogate::canopen
