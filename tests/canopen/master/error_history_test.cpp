// SPDX-License-Identifier: Apache-2.0
// 1003h of a node: what it names that no message has named is said, and nothing else.
#include <gtest/gtest.h>

#include "tests/canopen/master/pair.hpp"
#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using testing::Pair;
using testing::SegmentRig;

struct History : ::testing::Test {
  SegmentRig rig;
  void boots_with(std::initializer_list<std::uint32_t> entries) {
    rig.start();
    holds(entries);
    ASSERT_TRUE(rig.enable());
    rig.run(100);
  }
  /// Newest first.
  void holds(std::initializer_list<std::uint32_t> entries) {
    std::uint8_t n = 0;
    for (const std::uint32_t entry : entries) rig.device().set(0x1003, ++n, 4, entry);
    rig.device().set(0x1003, 0, 1, n);
  }
  void fault(std::uint16_t code) {
    rig.device().raise_fault(code, rig.network.waiting_out);
    rig.network.flush_out();
    rig.run(200);
  }
};

TEST_F(History, names_the_cause_of_which_no_message_came_and_not_what_was_told) {
  ASSERT_NO_FATAL_FAILURE(boots_with({0x3210, 0x4310}));
  holds({0x8611, 0x7305, 0x3210, 0x4310});
  fault(0x8611);
  EXPECT_EQ(rig.count(BusEventKind::error_history), 1);
  EXPECT_EQ(rig.sentence(BusEventKind::error_history),
            "X: error history 1003h:02 has 7305h, of which no message has come: incremental encoder 1 fault");
}

TEST_F(History, of_another_time_is_not_told) {
  ASSERT_NO_FATAL_FAILURE(boots_with({0x3210, 0x4310}));
  holds({0x8611, 0x3210, 0x4310});
  fault(0x8611);
  EXPECT_EQ(rig.count(BusEventKind::emcy), 1);
  EXPECT_EQ(rig.count(BusEventKind::error_history), 0);
}

TEST_F(History, that_is_full_gives_its_newest_entry) {
  ASSERT_NO_FATAL_FAILURE(boots_with({0x3210, 0x4310}));
  holds({0x7305, 0x3210});
  fault(0x8611);
  EXPECT_EQ(rig.count(BusEventKind::error_history), 1);
}

TEST_F(History, names_a_fault_from_before_the_boot_where_603Fh_does_not) {
  rig.start();
  rig.device().raise_fault(0x7305, rig.network.waiting_out);
  rig.network.waiting_out.clear();
  holds({0x7305, 0x4310});
  rig.device().erase(0x603F, 0);
  ASSERT_TRUE(rig.run_until([this] { return rig.drive().state == image::DriveState::fault; }));
  rig.run(200);
  EXPECT_EQ(rig.count(BusEventKind::error_history), 2);
  EXPECT_EQ(rig.count(BusEventKind::sdo_failed), 0);
}

TEST_F(History, is_asked_for_once_of_a_device_without_it) {
  rig.start();
  ASSERT_TRUE(rig.enable());
  rig.run(100);
  fault(0x8611);
  EXPECT_EQ(rig.count(BusEventKind::error_history), 0);
  EXPECT_EQ(rig.count(BusEventKind::sdo_failed), 0);
}

TEST(HistoryOfASimulatedDrive, says_nothing_where_all_of_its_messages_came) {
  Pair pair({}, [](NodeConfig&) {});
  ASSERT_TRUE(pair.enable()) << pair.story;
  fault::Fault fault;
  fault.kind = fault::Kind::over_current;
  pair.drive->inject(fault);
  pair.run(500);
  EXPECT_EQ(pair.story.find("error history"), std::string::npos) << pair.story;
  EXPECT_NE(pair.story.find("2310h"), std::string::npos) << pair.story;
}

TEST(HistoryOfASimulatedDrive, names_the_fault_whose_message_was_lost) {
  Pair pair({}, [](NodeConfig&) {});
  ASSERT_TRUE(pair.enable()) << pair.story;
  fault::Fault silent, fault;
  silent.kind = fault::Kind::silent;
  silent.duration_ns = 2 * image::kMillisecond;
  pair.drive->inject(silent);
  fault.kind = fault::Kind::emcy_only;
  fault.error_code = 0x7305;
  pair.drive->inject(fault);  // nobody hears its message
  pair.run(20);
  fault.error_code = 0x4210;
  pair.drive->inject(fault);
  pair.run(200);
  EXPECT_NE(pair.story.find("error history 1003h:02 has 7305h"), std::string::npos) << pair.story;
}

}  // namespace
}  // namespace servogate::canopen
