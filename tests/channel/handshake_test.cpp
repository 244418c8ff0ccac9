// SPDX-License-Identifier: Apache-2.0
// M, S, T and H words: strobe, acknowledgement, time-out, and their order beside motion.
#include <gtest/gtest.h>

#include "firmware_if/image/interface_map.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;

TEST(Handshake, hands_over_every_word_with_its_value_and_waits_for_each) {
  Rig rig("N10 T5.2 M6\nN20 S900 M3\nN30 M8\nN40 M5\nN50 M30\n");
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  std::string words;
  for (const Strobe& s : rig.logic.strobes) {
    words += s.word + std::to_string(static_cast<int>(s.code)) + " ";
    EXPECT_GE(s.acknowledged_s, 0.003);
    EXPECT_LE(s.acknowledged_s, 0.010);
  }
  EXPECT_EQ(words, "T5 M6 S900 M3 M8 M5 M30 ");
  EXPECT_EQ(rig.logic.strobes[0].value, 2.0) << "corrector of T5.2";
  EXPECT_EQ(rig.status().tool, 5);
}

TEST(Handshake, never_raises_a_strobe_while_the_acknowledgement_of_the_word_before_stands) {
  Rig rig("N10 M7\nN20 M8\nN30 M9\nN40 M30\n");
  rig.logic.delay_cycles = 0;
  int both = 0, rising = 0;
  bool last_strobe = false, last_ack = false;
  using image::field;
  const auto strobe = image::at(field(image::kProcessFields, "m_strobe"), image::process_base(0));
  const auto ack = image::at(field(image::kProcessFields, "m_ack"), image::process_base(0));
  rig.each = [&] {
    const bool s = rig.bit(strobe);
    if (s && !last_strobe) {
      ++rising;
      both += last_ack;
    }
    last_strobe = s;
    last_ack = rig.bit(ack);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(rising, 4);
  EXPECT_EQ(both, 0);
}

TEST(Handshake, that_is_never_acknowledged_stops_the_program_with_an_alarm_that_names_code_line_and_time) {
  Rig rig("N10 M8\nN20 M7\nN30 G0 X10\nN40 M30\n", "G27", 0.5);
  rig.logic.never = {7};
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 3.0));
  const image::AlarmRecord* a = rig.alarm(cycle::alarm::kMAckTimeout);
  ASSERT_NE(a, nullptr) << rig.alarm_list();
  EXPECT_EQ(a->value, 7.0);
  EXPECT_EQ(a->limit, 0.5);
  EXPECT_EQ(a->line, 2);
  EXPECT_EQ(a->block, 20);
  rig.run(1.0);
  EXPECT_EQ(rig.x(), 0.0) << "nothing behind it is executed";
  EXPECT_FALSE(rig.bit(image::at(image::field(image::kProcessFields, "m_strobe"), image::process_base(0))))
      << "the strobe falls";
}

TEST(Handshake, time_outs_of_s_t_and_h_have_alarms_of_their_own) {
  struct Case {
    const char* program;
    bool TestLogic::*acknowledge;
    image::AlarmNumber number;
  };
  for (const Case& c : {Case{"N10 S500 M3\n", &TestLogic::acknowledge_s, cycle::alarm::kSAckTimeout},
                        Case{"N10 T3\n", &TestLogic::acknowledge_t, cycle::alarm::kTAckTimeout},
                        Case{"N10 H7\n", &TestLogic::acknowledge_h, cycle::alarm::kHAckTimeout}}) {
    Rig rig(c.program, "G27", 0.1);
    rig.logic.*c.acknowledge = false;
    rig.start();
    EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 3.0)) << c.program;
    EXPECT_EQ(rig.alarms(c.number), 1) << c.program << rig.alarm_list();
  }
}

TEST(Handshake, with_a_code_that_the_plc_does_not_know_raises_an_alarm_and_moves_nothing_more) {
  Rig rig("N10 M77\nN20 G0 X10\nN30 M30\n");
  rig.logic.unknown = {77};
  rig.start();
  rig.run(2.0);
  const image::AlarmRecord* a = rig.alarm(cycle::alarm::kUnknownM);
  ASSERT_NE(a, nullptr) << rig.alarm_list();
  EXPECT_EQ(a->value, 77.0);
  EXPECT_EQ(a->line, 1);
  EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
  EXPECT_EQ(rig.x(), 0.0);
}

TEST(Handshake, stands_between_the_motions_before_and_behind_it) {
  Rig rig("N10 G1 X10 F6000\nN20 M8\nN30 X20\nN40 M9\nN50 M30\n");
  rig.logic.delay_cycles = 200;
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  ASSERT_EQ(rig.logic.strobes.size(), 3u);
  EXPECT_NEAR(rig.logic.strobes[0].x, 10.0, 1e-9);
  EXPECT_NEAR(rig.logic.strobes[1].x, 20.0, 1e-9);
  for (const Strobe& s : rig.logic.strobes) EXPECT_FALSE(s.moving);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Handshake, of_m3_in_a_block_with_motion_comes_before_it_and_of_m5_after_it) {
  Rig rig("N10 G0 X10 M3\nN20 G0 X20 M5\nN30 M30\n");
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  ASSERT_EQ(rig.logic.strobes.size(), 3u);
  EXPECT_EQ(rig.logic.strobes[0].code, 3.0);
  EXPECT_NEAR(rig.logic.strobes[0].x, 0.0, 1e-9);
  EXPECT_EQ(rig.logic.strobes[1].code, 5.0);
  EXPECT_NEAR(rig.logic.strobes[1].x, 20.0, 1e-9);
}

TEST(Handshake, between_blocks_of_a_continuous_profile_is_an_implicit_stop) {
  Rig rig("N10 G27 G1 X20 F6000\nN20 M8\nN30 X40\nN40 X60\nN50 M30\n");
  double slowest_between_30_and_50 = 1e9;
  rig.each = [&] {
    if (rig.x() > 30 && rig.x() < 50)
      slowest_between_30_and_50 = std::min(slowest_between_30_and_50, rig.status().feed_mm_s);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(slowest_between_30_and_50, 90.0) << "no stop where there is no function";
  EXPECT_NEAR(rig.logic.strobes[0].x, 20.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Handshake, is_dropped_by_reset_and_a_new_start_begins_clean) {
  Rig rig("N10 M8\nN20 G0 X5\nN30 M30\n", "G27", 10.0);
  rig.logic.never = {8};
  rig.start();
  rig.run(0.2);
  EXPECT_EQ(rig.state(), ProcessState::waiting);
  EXPECT_EQ(rig.ask(image::RequestKind::reset), cycle::Refusal::none);
  EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle; }, 1.0));
  EXPECT_FALSE(rig.bit(image::at(image::field(image::kProcessFields, "m_strobe"), image::process_base(0))));
  rig.logic.never.clear();
  ASSERT_TRUE(rig.finish()) << rig.alarm_list() << " state " << static_cast<int>(rig.state()) << " x "
                            << rig.x();
  EXPECT_NEAR(rig.x(), 5.0, 1e-9);
}

}  // namespace
}  // namespace servogate::channel::test
