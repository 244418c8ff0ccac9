// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/example_machine.hpp"

namespace servogate::plc {
namespace {

struct Lathe : ExampleMachine {
  Lathe()
      : ExampleMachine("examples/lathe/lathe.st", {"X", "Z"},
                       {{"door_closed", 16},
                        {"estop_chain_ok", 17},
                        {"chuck_closed", 18},
                        {"turret_pos_1", 21},
                        {"turret_pos_2", 22},
                        {"turret_pos_3", 23},
                        {"turret_locked", 24}},
                       {{"spindle_contactor", 64},
                        {"coolant", 65},
                        {"lamp_green", 67},
                        {"lamp_red", 68},
                        {"turret_motor", 69},
                        {"chuck_close", 71}}) {
    set("chuck_closed", 1);
    set("turret_locked", 1);
    set("turret_pos_1", 1);
    power_up();
  }
  /// The turret's mechanics: 600 ms a station, none in front for the first half; the lock falls in 100 ms
  /// after the motor stops.
  void machine(int& turned_ms, int& still_ms) {
    cycle();
    if (on("turret_motor")) {
      ++turned_ms;
      still_ms = 0;
    } else {
      ++still_ms;
    }
    const int station = turned_ms / 600 % 3;
    const bool between = turned_ms % 600 > 0 && turned_ms % 600 < 300;
    for (int i = 0; i < 3; ++i)
      set("turret_pos_" + std::to_string(i + 1),
          !between && i == (turned_ms % 600 >= 300 ? (station + 1) % 3 : station));
    set("turret_locked", still_ms >= 100);
  }
};

TEST(ExampleLathe, turns_the_turret_to_the_station_of_the_T_word_and_waits_for_the_lock) {
  Lathe m;
  int turned = 0, still = 200, waited = 0;
  m.set("NC.t_number", 3);
  m.set("NC.t_strobe", 1);
  while (!m.on("NC.t_ack") && waited < 10'000) m.machine(turned, still), ++waited;
  EXPECT_TRUE(m.on("turret_pos_3"));
  EXPECT_TRUE(m.on("turret_locked"));
  EXPECT_FALSE(m.on("turret_motor"));
  EXPECT_GT(waited, 900);
  EXPECT_LT(waited, 1100);
  m.set("NC.t_strobe", 0);
  EXPECT_EQ(m.until("NC.t_ack", 0, 2), 1);
}

TEST(ExampleLathe, starts_nothing_when_the_door_is_closed_again) {
  Lathe m;
  m.set("chuck_closed", 1);
  m.set("NC.running", 1);
  m.set("S.run", 1);
  m.strobe_m(3);
  m.until("S.enable", 1);
  m.set("S.at_speed", 1);
  m.cycle();
  m.finish_m();
  m.set("door_closed", 0);
  m.cycle();
  EXPECT_TRUE(m.on("NC.stop"));
  for (const char* name : {"S.enable", "X.feed_enable", "Z.feed_enable", "NC.feed_enable"})
    EXPECT_FALSE(m.on(name)) << name;
  m.set("NC.held", 1);
  m.set("S.at_speed", 0);
  m.set("S.zero_speed", 1);
  m.set("door_closed", 1);
  m.cycles(500);
  for (const char* name : {"S.enable", "spindle_contactor", "NC.feed_enable"})
    EXPECT_FALSE(m.on(name)) << name;
  m.set("NC.held", 0);
  EXPECT_GE(m.until("S.enable", 1), 100);
  EXPECT_FALSE(m.on("NC.feed_enable"));
  m.set("S.at_speed", 1);
  m.cycle();
  EXPECT_TRUE(m.on("NC.feed_enable"));
}

TEST(ExampleLathe, turns_no_turret_and_moves_no_chuck_behind_an_open_door) {
  Lathe m;
  m.set("NC.running", 1);
  m.set("S.zero_speed", 1);
  m.set("NC.t_number", 2);
  m.set("NC.t_strobe", 1);
  m.cycle();
  ASSERT_TRUE(m.on("turret_motor"));
  m.set("door_closed", 0);
  m.cycle();
  EXPECT_FALSE(m.on("turret_motor"));
  m.set("NC.held", 1);
  m.set("door_closed", 1);
  m.cycles(500);
  EXPECT_FALSE(m.on("turret_motor")) << "until somebody resumes";
  m.set("NC.held", 0);
  m.cycles(2);
  EXPECT_TRUE(m.on("turret_motor"));
  m.set("NC.t_strobe", 0);
  m.cycles(400);
  ASSERT_TRUE(m.on("chuck_close"));
  m.set("door_closed", 0);
  m.strobe_m(69);
  m.cycles(100);
  EXPECT_TRUE(m.on("chuck_close")) << "the part would drop";
}

TEST(ExampleLathe, holds_the_axes_while_the_turret_turns) {
  Lathe m;
  m.set("NC.t_number", 2);
  m.set("NC.t_strobe", 1);
  m.cycles(2);
  EXPECT_TRUE(m.on("turret_motor"));
  EXPECT_FALSE(m.on("X.feed_enable"));
  EXPECT_FALSE(m.on("NC.feed_enable"));
}

TEST(ExampleLathe, acknowledges_at_once_the_station_that_stands_in_front_and_T0) {
  for (const int t : {1, 0}) {
    Lathe m;
    m.set("NC.t_number", t);
    m.set("NC.t_strobe", 1);
    EXPECT_EQ(m.until("NC.t_ack", 1, 5), 1);
    EXPECT_FALSE(m.on("turret_motor"));
  }
}

TEST(ExampleLathe, refuses_a_station_it_does_not_have_and_reports_one_it_never_reaches) {
  Lathe m;
  m.set("NC.t_number", 4);
  m.set("NC.t_strobe", 1);
  EXPECT_EQ(m.until("NC.external_alarm", 703, 5), 1);
  EXPECT_FALSE(m.on("NC.t_ack"));
  m.set("NC.t_strobe", 0);
  EXPECT_EQ(m.until("NC.external_alarm", 0, 5), 1);
  m.set("NC.t_number", 2);
  m.set("NC.t_strobe", 1);
  EXPECT_GE(m.until("NC.external_alarm", 704), 6000);
  EXPECT_FALSE(m.on("turret_motor"));
}

TEST(ExampleLathe, does_not_turn_the_spindle_with_the_chuck_open) {
  Lathe m;
  m.set("chuck_closed", 0);
  m.strobe_m(3);
  m.cycles(300);
  EXPECT_FALSE(m.on("spindle_contactor"));
  EXPECT_FALSE(m.on("S.enable"));
  EXPECT_EQ(m.get("NC.external_alarm"), 705);
}

TEST(ExampleLathe, starts_the_spindle_by_M13_with_coolant_and_stops_it_by_M5) {
  Lathe m;
  m.set("S.run", 1);
  m.strobe_m(13);
  EXPECT_EQ(m.until("S.enable", 1), 101);
  m.set("S.at_speed", 1);
  m.set("S.zero_speed", 0);
  EXPECT_LE(m.until("NC.m_ack", 1), 2);
  EXPECT_TRUE(m.on("coolant"));
  m.finish_m();
  m.strobe_m(5);
  m.cycles(10);
  EXPECT_FALSE(m.on("NC.m_ack"));
  m.set("S.zero_speed", 1);
  EXPECT_EQ(m.until("NC.m_ack", 1), 1);
  EXPECT_FALSE(m.on("coolant"));
}

TEST(ExampleLathe, keeps_the_chuck_as_it_found_it_and_opens_it_at_standstill_only) {
  Lathe m;
  EXPECT_TRUE(m.on("chuck_close"));
  m.set("S.zero_speed", 0);
  m.strobe_m(69);
  m.cycles(50);
  EXPECT_TRUE(m.on("chuck_close"));
  m.set("S.zero_speed", 1);
  m.cycle();
  EXPECT_FALSE(m.on("chuck_close"));
  EXPECT_FALSE(m.on("NC.m_ack"));
  m.set("chuck_closed", 0);
  m.cycle();
  EXPECT_TRUE(m.on("NC.m_ack"));
  m.finish_m();
  m.strobe_m(68);
  m.cycle();
  EXPECT_TRUE(m.on("chuck_close"));
}

TEST(ExampleLathe, counts_parts_and_tells_unknown_M_codes) {
  Lathe m;
  m.set("NC.program_end", 1);
  m.cycles(3);
  EXPECT_EQ(m.packets.number({image::Packet::k, image::Format::in, 10, 1}), 1);
  m.strobe_m(99);
  m.cycle();
  EXPECT_TRUE(m.on("NC.m_ack"));
  EXPECT_TRUE(m.on("NC.m_unknown"));
}

}  // namespace
}  // namespace servogate::plc
