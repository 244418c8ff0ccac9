// SPDX-License-Identifier: Apache-2.0
// Dwell, waits, and reads and writes of packets beside motion (cases T-SYN of the language).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;

/// Seconds of machine time from now until the bit is on; negative: it never was.
double time_until(Rig& rig, image::Place bit, double patience_s) {
  const double begin = rig.now();
  return rig.until([&] { return rig.bit(bit); }, patience_s) ? rig.now() - begin : -1.0;
}

TEST(Dwell, lasts_as_long_as_it_says_and_begins_when_the_axes_are_in_position) {
  Rig rig("N10 G0 X1\nN15 TMR=0.4\nN20 G4\nN30 SK10=1\nN40 M30\n");
  double arrived = 0.0;
  rig.each = [&] {
    if (arrived == 0.0 && rig.x() == 1.0 && !rig.moving()) arrived = rig.now();
  };
  rig.start();
  ASSERT_EQ(rig.started(), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  Rig without("N10 G0 X1\nN30 SK10=1\nN40 M30\n");
  ASSERT_TRUE(without.finish()) << without.alarm_list();
  // Both programs are alike but for the dwell, so are the times before and behind it.
  EXPECT_NEAR(rig.now() - without.now(), 0.4, 0.005);
  EXPECT_GT(arrived, 0.0);
}

TEST(Synchronisation, write_of_a_signal_waits_for_the_motion_before_it) {
  // T-SYN-01, with one second of motion in place of ten.
  Rig rig("N10 G1 X50 F3000\nN20 SA128=1\nN30 M30\n");
  rig.start();
  const double t = time_until(rig, sa(128), 5.0);
  EXPECT_GT(t, 1.0);
  EXPECT_LT(t, 1.4);
  EXPECT_NEAR(rig.x(), 50.0, 1e-9);
}

TEST(Synchronisation, write_with_ampersand_does_not_wait) {
  Rig rig("N10 G1 X50 F3000\nN20 & SA128=1\nN30 M30\n");
  rig.start();
  const double t = time_until(rig, sa(128), 5.0);
  EXPECT_GE(t, 0.0);
  EXPECT_LT(t, 0.9) << "set during the move";
  EXPECT_LT(rig.x(), 45.0);
}

TEST(Synchronisation, write_of_a_system_variable_does_not_wait_but_with_hash_it_does) {
  // T-SYN-02.
  const auto when = [](const char* block, double& next_motion_from) {
    Rig rig(std::string("N10 G1 X50 F3000\n") + block + "\nN30 G1 X60\nN40 M30\n");
    rig.start();
    const image::Place v{image::Packet::v, image::Format::by, 5, 1};
    const double begin = rig.now();
    double t = -1.0;
    next_motion_from = -1.0;
    EXPECT_TRUE(rig.until(
        [&] {
          if (t < 0.0 && rig.image().packets.number(v) == 1.0) t = rig.now() - begin;
          if (next_motion_from < 0.0 && rig.x() > 50.001) next_motion_from = rig.now() - begin;
          return rig.state() == ProcessState::ended;
        },
        10.0))
        << rig.alarm_list();
    return t;
  };
  double next = 0.0;
  const double plain = when("N20 SYVAR5.BY=1", next);
  EXPECT_GE(plain, 0.0);
  EXPECT_LT(plain, 0.9);
  const double synchronised = when("N20 # SYVAR5.BY=1", next);
  EXPECT_GT(synchronised, 1.0);
  EXPECT_GT(next, synchronised) << "the next move starts after it";
}

TEST(Synchronisation, branch_on_a_signal_samples_it_when_the_motion_before_has_ended) {
  // T-SYN-05: the signal comes while the axis moves, long after the reader has seen the branch.
  for (const bool set : {false, true}) {
    Rig rig("N10 G1 X50 F3000\nN20 (BEQ,SA3,1,L1)\nN30 G0 Y-10\nN40 M30\n\"L1\"N50 G0 Y10\nN60 M30\n");
    rig.start();
    rig.run(0.8);
    EXPECT_LT(rig.x(), 49.0);
    image::Request r;
    r.asker = image::Asker::scenario;
    r.kind = image::RequestKind::force;
    r.packet = 0;
    r.format = static_cast<std::uint8_t>(image::Format::bl);
    r.index = 3;
    r.value = set ? 1.0 : 0.0;
    r.id = 999;
    ASSERT_TRUE(rig.cycle->post(r));
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
    EXPECT_NEAR(rig.x(1), set ? 10.0 : -10.0, 1e-9);
  }
}

TEST(Synchronisation, read_of_a_word_sees_what_the_cycle_wrote_just_before) {
  Rig rig("N10 SK10.IN=41\nN20 G0 X1\nN30 E30=SK10.IN\nN40 G0 XE30\nN50 M30\n");
  rig.each = [&] {
    // Somebody else writes while the axis moves to X1.
    if (rig.x() > 0.2 && rig.x() < 0.8) {
      image::Request r;
      r.kind = image::RequestKind::set_place;
      r.packet = static_cast<std::uint8_t>(image::Packet::k);
      r.format = static_cast<std::uint8_t>(image::Format::in);
      r.index = 10;
      r.value = 42.0;
      r.id = 7;
      rig.cycle->post(r);
    }
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 42.0, 1e-9);
}

TEST(Synchronisation, wait_goes_on_when_the_signal_comes_and_not_before) {
  Rig rig("N10 (WAI,SA5=1)\nN20 G0 X10\nN30 M30\n");
  rig.start();
  rig.run(2.0);
  EXPECT_EQ(rig.state(), ProcessState::waiting);
  EXPECT_EQ(rig.x(), 0.0);
  image::Request r;
  r.asker = image::Asker::scenario;
  r.kind = image::RequestKind::force;
  r.index = 5;
  r.value = 1.0;
  ASSERT_TRUE(rig.cycle->post(r));
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, 5.0)) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 10.0, 1e-9);
}

TEST(Synchronisation, read_in_enable_holds_the_reading_back) {
  Rig rig("N10 G0 X1\nN20 E1=SK10.IN\nN30 G0 X2\nN40 M30\n");
  rig.logic.read_in_enable = false;
  rig.start();
  rig.run(2.0);
  EXPECT_NEAR(rig.x(), 1.0, 1e-9);
  rig.logic.read_in_enable = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, 5.0)) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 2.0, 1e-9);
}

TEST(Stops, m00_waits_for_start_and_m01_only_where_the_plc_wants_it) {
  for (const bool optional : {false, true}) {
    Rig rig("N10 G0 X1\nN20 M01\nN30 G0 X2\nN40 M00\nN50 G0 X3\nN60 M30\n");
    rig.logic.optional_stop = optional;
    rig.start();
    rig.run(2.0);
    EXPECT_EQ(rig.state(), ProcessState::waiting);
    EXPECT_NEAR(rig.x(), optional ? 1.0 : 2.0, 1e-9);
    if (optional) {
      rig.logic.start_bit = true;
      rig.run(0.01);
      rig.logic.start_bit = false;
      rig.run(2.0);
      EXPECT_NEAR(rig.x(), 2.0, 1e-9) << "the PLC's start button goes on behind M01";
    }
    EXPECT_EQ(rig.ask(image::RequestKind::start), cycle::Refusal::none) << "and the operator's behind M00";
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, 5.0)) << rig.alarm_list();
    EXPECT_NEAR(rig.x(), 3.0, 1e-9);
  }
}

}  // namespace
}  // namespace servogate::channel::test
