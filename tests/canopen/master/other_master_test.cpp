// SPDX-License-Identifier: Apache-2.0
// A bus has one master: what a segment says and does when somebody else leads the bus.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::SegmentRig;

struct OtherMaster : ::testing::Test {
  OtherMaster() : rig(2) {
    rig.start();
    ready = rig.boot() && rig.enable();
    rig.events.clear();
  }
  void hear(const image::CanFrame& f) { rig.network.waiting.push_back(f); }
  /// Frames that the control has sent in a cycle.
  std::size_t sent_in_a_cycle() {
    rig.step();
    return rig.network.last_sent.size();
  }
  SegmentRig rig;
  bool ready = false;
};

TEST_F(OtherMaster, is_named_with_each_kind_of_frame_in_every_cycle_in_which_it_speaks) {
  ASSERT_TRUE(ready);
  for (int i = 0; i < 10; ++i) {
    hear(frame(0x80, {}));
    hear(frame(0x80, {}));
    hear(frame(0x000, {0x80, 0x01}));
    hear(frame(0x201, {0x0F, 0, 1, 2, 3, 4}));
    hear(frame(0x602, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0}));  // a controlword
    hear(frame(0x77F, {0x05}));
    hear(frame(0x215, {1}));  // RPDO of a node that is none of ours
    rig.step();
  }
  EXPECT_EQ(rig.count(BusEventKind::foreign_frame), 50);
  std::vector<std::string> sentences;
  for (const BusEvent& e : rig.events)
    if (e.kind == BusEventKind::foreign_frame)
      sentences.push_back(describe(e, "can0", nullptr, text::Language::english));
  EXPECT_EQ(sentences[2],
            "can0: frame 201h [0F 00 01 02 03 04] comes from somebody else; another master is on the bus");
}

TEST_F(OtherMaster, is_there_for_a_second_behind_its_last_frame) {
  ASSERT_TRUE(ready);
  hear(frame(0x201, {0x0F, 0, 1, 2, 3, 4}));
  rig.run(1000);
  EXPECT_EQ(rig.count(BusEventKind::foreign_frame), 1000);
  EXPECT_EQ(rig.last(BusEventKind::foreign_frame)->node, 1);
  EXPECT_EQ(rig.last(BusEventKind::foreign_frame)->frame.id, 0x201u);
  rig.run(1000);
  EXPECT_EQ(rig.count(BusEventKind::foreign_frame), 1000);
}

TEST_F(OtherMaster, is_nobody_who_only_asks_for_objects) {
  ASSERT_TRUE(ready);
  for (int i = 0; i < 100; ++i) {
    hear(frame(0x602, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
    rig.step();
  }
  EXPECT_EQ(rig.count(BusEventKind::foreign_frame), 0);
  EXPECT_EQ(rig.count(BusEventKind::foreign_request), 1) << "once a second";
  EXPECT_EQ(rig.sentence(BusEventKind::foreign_request),
            "X: request 602h [40 41 60 00 00 00 00 00] comes from somebody else");
}

TEST(Segment, does_not_hold_against_anybody_what_was_said_before_it_began) {
  SegmentRig rig;
  rig.start();
  // More than one cycle takes.
  for (int i = 0; i < 2000; ++i) {
    rig.network.waiting.push_back(frame(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
    rig.network.waiting.push_back(frame(0x080, {}));
  }
  ASSERT_TRUE(rig.boot());
  EXPECT_EQ(rig.count(BusEventKind::foreign_request) + rig.count(BusEventKind::foreign_frame), 0);
  rig.network.waiting.push_back(frame(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
  rig.step();
  EXPECT_EQ(rig.count(BusEventKind::foreign_request), 1);
}

TEST(Segment, that_has_listened_before_it_began_holds_everything_against_everybody) {
  SegmentRig rig;
  rig.start();
  rig.segment->listened();
  rig.network.waiting.push_back(frame(0x080, {}));
  rig.step();
  EXPECT_EQ(rig.count(BusEventKind::foreign_frame), 1);
}

TEST_F(OtherMaster, that_took_the_place_of_a_control_that_stood_still_is_left_alone_for_good) {
  ASSERT_TRUE(ready);
  // What waited meanwhile is more than a cycle takes, and the other one's frames are behind it.
  for (int i = 0; i < 1000; ++i) hear(frame(0x701, {0x05}));
  hear(frame(0x201, {0x0F, 0, 1, 2, 3, 4}));
  rig.segment->came_back(3 * image::kSecond);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(sent_in_a_cycle(), 0u) << i;
  ASSERT_EQ(rig.count(BusEventKind::lead_lost), 1);
  EXPECT_EQ(rig.last(BusEventKind::lead_lost)->got, 3000);
  EXPECT_EQ(rig.sentence(BusEventKind::lead_lost),
            "X: this control stood still for 3000 ms and another one leads the bus now, as frame 201h [0F 00 "
            "01 02 03 04] shows; nothing is sent any more");
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(sent_in_a_cycle(), 0u) << i;
    if (i % 4 == 0) hear(frame(0x080, {}));
  }
  EXPECT_EQ(rig.count(BusEventKind::lead_lost), 4) << "once a second, so that a reset does not hide it";
  EXPECT_FALSE(rig.drive().online);
  EXPECT_FALSE(rig.image->segments[0].operational);
  EXPECT_TRUE(rig.segment->leave(rig.image->now.t_ns)) << "the other one's drives are not taken leave of";
  rig.step();
  EXPECT_TRUE(rig.network.last_sent.empty());
}

TEST_F(OtherMaster, that_is_not_there_lets_a_control_go_on_after_it_has_looked) {
  ASSERT_TRUE(ready);
  rig.segment->came_back(2 * image::kSecond);
  int silent = 0;
  while (silent < 1000 && sent_in_a_cycle() == 0) ++silent;
  EXPECT_GE(silent, 50) << "longer than a SYNC period of another master";
  EXPECT_LT(silent, 60);
  EXPECT_EQ(rig.count(BusEventKind::lead_lost), 0);
  EXPECT_TRUE(rig.run_until([&] { return rig.image->segments[0].operational; }));
}

TEST_F(OtherMaster, is_not_disturbed_by_the_leave_of_this_control) {
  ASSERT_TRUE(ready);
  hear(frame(0x080, {}));
  rig.step();
  rig.network.sent.clear();
  EXPECT_TRUE(rig.segment->leave(rig.image->now.t_ns));
  EXPECT_TRUE(rig.network.sent.empty());
}

}  // namespace
}  // namespace servogate::canopen
