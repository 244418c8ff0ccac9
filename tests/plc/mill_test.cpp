// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/example_machine.hpp"

namespace servogate::plc {
namespace {

struct Mill : ExampleMachine {
  Mill()
      : ExampleMachine("examples/mill/mill.st", {"X", "Y", "Z"},
                       {{"door_closed", 16}, {"estop_chain_ok", 17}, {"air_ok", 18}, {"tool_clamped", 19}},
                       {{"spindle_contactor", 64},
                        {"coolant", 65},
                        {"mist", 66},
                        {"lamp_green", 67},
                        {"lamp_red", 68},
                        {"tool_release", 69}}) {}
  void power_up() {
    set("tool_clamped", 1);
    ExampleMachine::power_up();
  }
};

TEST(ExampleMill, opens_everything_when_the_emergency_stop_chain_opens) {
  Mill m;
  m.power_up();
  for (const char* name : {"MC.estop_ok", "MC.power_on", "X.enable", "Y.enable", "Z.enable", "X.feed_enable",
                           "NC.feed_enable", "NC.read_in_enable"})
    EXPECT_TRUE(m.on(name)) << name;
  EXPECT_FALSE(m.on("lamp_red"));
  m.set("estop_chain_ok", 0);
  m.cycle();
  for (const char* name : {"MC.estop_ok", "MC.power_on", "X.enable", "Y.enable", "Z.enable", "X.feed_enable",
                           "NC.feed_enable", "NC.read_in_enable", "S.enable", "spindle_contactor", "coolant"})
    EXPECT_FALSE(m.on(name)) << name;
  EXPECT_TRUE(m.on("lamp_red"));
}

TEST(ExampleMill, needs_the_operators_wish_for_power) {
  Mill m;
  m.set("estop_chain_ok", 1);
  m.cycle();
  EXPECT_TRUE(m.on("MC.estop_ok"));
  EXPECT_FALSE(m.on("MC.power_on"));
  EXPECT_FALSE(m.on("X.enable"));
}

TEST(ExampleMill, holds_the_feed_while_the_door_is_open) {
  Mill m;
  m.power_up();
  m.set("door_closed", 0);
  m.cycle();
  EXPECT_FALSE(m.on("NC.feed_enable"));
  EXPECT_TRUE(m.on("X.enable"));
}

TEST(ExampleMill, starts_nothing_when_the_door_is_closed_again) {
  Mill m;
  m.power_up();
  m.set("NC.running", 1);
  m.set("S.run", 1);
  m.strobe_m(13);
  m.until("S.enable", 1);
  m.set("S.at_speed", 1);
  m.cycle();
  m.finish_m();
  ASSERT_TRUE(m.on("coolant"));
  m.set("door_closed", 0);
  m.cycle();
  EXPECT_TRUE(m.on("NC.stop"));
  EXPECT_FALSE(m.on("coolant"));
  EXPECT_FALSE(m.on("S.enable"));
  m.set("NC.held", 1);
  m.set("S.at_speed", 0);
  m.set("door_closed", 1);
  m.cycles(500);
  for (const char* name : {"NC.stop", "NC.feed_enable", "coolant", "S.enable", "spindle_contactor"})
    EXPECT_FALSE(m.on(name)) << name;
  m.set("NC.held", 0);  // resume
  m.cycle();
  EXPECT_TRUE(m.on("coolant"));
  EXPECT_EQ(m.until("S.enable", 1), 100);
  EXPECT_FALSE(m.on("NC.feed_enable")) << "the spindle does not turn yet";
  m.set("S.at_speed", 1);
  m.cycle();
  EXPECT_TRUE(m.on("NC.feed_enable"));
  m.set("S.at_speed", 0);
  m.cycle();
  EXPECT_TRUE(m.on("NC.feed_enable")) << "a new speed on the way holds nothing";
}

TEST(ExampleMill, lets_no_tool_go_behind_an_open_door_and_begins_the_change_anew) {
  Mill m;
  m.power_up();
  m.set("NC.running", 1);
  m.set("air_ok", 1);
  m.set("tool_clamped", 1);
  m.set("S.zero_speed", 0);
  m.strobe_m(6);
  m.cycles(20);
  m.set("door_closed", 0);
  m.set("NC.held", 1);
  m.cycle();
  m.set("S.zero_speed", 1);
  m.cycles(1000);
  EXPECT_FALSE(m.on("tool_release"));
  m.set("door_closed", 1);
  m.cycles(1000);
  EXPECT_FALSE(m.on("tool_release")) << "closing it lets nothing go either";
  EXPECT_FALSE(m.on("NC.m_ack"));
  m.set("NC.held", 0);
  EXPECT_LE(m.until("tool_release", 1), 4);
  EXPECT_GE(m.until("NC.m_ack", 1), 500);
}

TEST(ExampleMill, switches_off_what_a_program_switched_on_when_it_is_given_up) {
  Mill m;
  m.power_up();
  m.set("NC.running", 1);
  m.set("NC.state", 1);
  m.strobe_m(13);
  m.until("NC.m_ack", 1);
  m.finish_m();
  m.strobe_m(6);
  m.cycles(3);
  for (const char* name : {"NC.m_strobe", "NC.running", "NC.state"}) m.set(name, 0);  // reset
  m.cycles(3);
  for (const char* name : {"coolant", "mist", "S.enable"}) EXPECT_FALSE(m.on(name)) << name;
}

TEST(ExampleMill, keeps_the_spindle_of_a_typed_block_that_has_ended) {
  Mill m;
  m.power_up();
  m.set("NC.running", 1);
  m.set("NC.state", 1);
  m.strobe_m(3);
  m.until("S.enable", 1);
  m.finish_m();
  m.set("NC.running", 0);
  m.set("NC.state", 5);
  m.cycles(10);
  EXPECT_TRUE(m.on("S.enable"));
}

TEST(ExampleMill, forgets_what_an_open_door_interrupted_when_no_program_is_left_to_resume) {
  Mill m;
  m.power_up();
  m.set("NC.running", 1);
  m.strobe_m(13);
  m.until("NC.m_ack", 1);
  m.finish_m();
  m.set("door_closed", 0);
  m.set("NC.held", 1);
  m.cycles(5);
  m.set("door_closed", 1);
  m.cycles(5);
  m.set("NC.running", 0);
  m.set("NC.held", 0);
  m.cycles(500);
  for (const char* name : {"coolant", "S.enable", "spindle_contactor"}) EXPECT_FALSE(m.on(name)) << name;
}

TEST(ExampleMill, closes_the_contactor_before_the_spindle_and_acknowledges_M3_at_speed) {
  for (const int code : {3, 4, 13, 14}) {
    Mill m;
    m.power_up();
    m.set("S.run", 1);
    m.strobe_m(code);
    m.cycle();
    EXPECT_TRUE(m.on("spindle_contactor"));
    EXPECT_FALSE(m.on("S.enable"));
    EXPECT_EQ(m.until("S.enable", 1), 100);
    EXPECT_EQ(m.on("coolant"), code >= 13);
    m.set("S.zero_speed", 0);
    m.cycles(500);
    EXPECT_FALSE(m.on("NC.m_ack")) << "not at speed yet";
    m.set("S.at_speed", 1);
    m.cycle();
    EXPECT_TRUE(m.on("NC.m_ack"));
    m.set("S.at_speed", 0);
    m.cycles(3);
    EXPECT_TRUE(m.on("NC.m_ack")) << "stays until the strobe falls";
    m.finish_m();
    EXPECT_TRUE(m.on("S.enable"));
  }
}

TEST(ExampleMill, acknowledges_M5_at_standstill_and_opens_the_contactor) {
  Mill m;
  m.power_up();
  m.strobe_m(3);
  m.until("NC.m_ack", 1);
  m.finish_m();
  m.set("S.zero_speed", 0);
  m.strobe_m(5);
  m.cycles(50);
  EXPECT_FALSE(m.on("NC.m_ack"));
  EXPECT_TRUE(m.on("spindle_contactor"));
  m.set("S.zero_speed", 1);
  m.cycle();
  EXPECT_TRUE(m.on("NC.m_ack"));
  EXPECT_FALSE(m.on("spindle_contactor"));
  m.finish_m();
}

TEST(ExampleMill, switches_coolant_and_mist_by_M7_M8_M9) {
  Mill m;
  m.power_up();
  for (const auto& [code, coolant, mist] : {std::tuple{8, true, false}, {7, true, true}, {9, false, false}}) {
    m.strobe_m(code);
    EXPECT_EQ(m.until("NC.m_ack", 1, 2), 1) << "M" << code;
    EXPECT_EQ(m.on("coolant"), coolant) << "M" << code;
    EXPECT_EQ(m.on("mist"), mist) << "M" << code;
    m.finish_m();
  }
}

TEST(ExampleMill, changes_a_tool_with_the_spindle_at_rest_and_waits_for_the_clamp) {
  Mill m;
  m.power_up();
  m.set("air_ok", 1);
  m.set("tool_clamped", 1);
  m.strobe_m(8);
  m.cycle();
  m.finish_m();
  m.set("S.zero_speed", 0);
  m.strobe_m(6);
  m.cycles(20);
  EXPECT_FALSE(m.on("tool_release")) << "the spindle still turns";
  EXPECT_FALSE(m.on("coolant"));
  EXPECT_FALSE(m.on("NC.read_in_enable"));
  m.set("S.zero_speed", 1);
  EXPECT_LE(m.until("tool_release", 1), 3);
  m.set("tool_clamped", 0);
  const int open_ms = m.until("tool_release", 0);
  EXPECT_GE(open_ms, 500);
  EXPECT_LE(open_ms, 502);
  m.cycles(300);
  EXPECT_FALSE(m.on("NC.m_ack"));
  m.set("tool_clamped", 1);
  EXPECT_LE(m.until("NC.m_ack", 1), 2);
  m.finish_m();
  EXPECT_EQ(m.until("NC.read_in_enable", 1, 3), 1);
  EXPECT_TRUE(m.on("coolant")) << "M8 is not forgotten over M6";
}

TEST(ExampleMill, says_which_part_of_a_tool_change_failed) {
  Mill m;
  m.power_up();
  m.strobe_m(6);
  EXPECT_GE(m.until("NC.external_alarm", 702), 2000) << "no air";
  m.set("air_ok", 1);
  m.set("tool_clamped", 0);
  m.until("tool_release", 0);
  EXPECT_GE(m.until("NC.external_alarm", 701), 2000) << "no clamp";
  EXPECT_FALSE(m.on("NC.m_ack"));
  m.set("NC.m_strobe", 0);
  EXPECT_EQ(m.until("NC.external_alarm", 0, 3), 1);
}

TEST(ExampleMill, tells_an_unknown_M_code) {
  Mill m;
  m.power_up();
  m.strobe_m(77);
  EXPECT_EQ(m.until("NC.m_ack", 1, 2), 1);
  EXPECT_TRUE(m.on("NC.m_unknown"));
  m.finish_m();
}

TEST(ExampleMill, acknowledges_S_T_and_H_and_drops_them_with_the_strobe) {
  Mill m;
  m.power_up();
  for (const char* word : {"s", "t", "h"}) {
    const std::string strobe = std::string("NC.") + word + "_strobe",
                      ack = std::string("NC.") + word + "_ack";
    m.set(strobe, 1);
    EXPECT_EQ(m.until(ack, 1, 2), 1) << word;
    m.set(strobe, 0);
    EXPECT_EQ(m.until(ack, 0, 2), 1) << word;
  }
}

TEST(ExampleMill, lights_green_while_running_and_red_in_alarm) {
  Mill m;
  m.power_up();
  EXPECT_FALSE(m.on("lamp_green"));
  m.set("NC.running", 1);
  m.cycle();
  EXPECT_TRUE(m.on("lamp_green"));
  m.set("NC.held", 1);
  m.set("MC.alarm", 1);
  m.cycle();
  EXPECT_FALSE(m.on("lamp_green"));
  EXPECT_TRUE(m.on("lamp_red"));
}

TEST(ExampleMill, counts_a_part_once_at_each_program_end) {
  Mill m;
  m.power_up();
  const image::Place parts{image::Packet::k, image::Format::in, 10, 1};
  for (int part = 1; part <= 3; ++part) {
    m.set("NC.program_end", 1);
    m.cycles(5);
    EXPECT_EQ(m.packets.number(parts), part);
    m.set("NC.program_end", 0);
    m.cycles(5);
  }
}

TEST(ExampleMill, sprays_mist_while_the_part_program_asks_in_SK10) {
  Mill m;
  m.power_up();
  const image::Place phase{image::Packet::k, image::Format::by, 10, 1};
  for (const auto& [value, mist] : {std::pair{1, true}, {2, true}, {3, false}, {0, false}}) {
    m.packets.set_number(phase, value);
    m.cycle();
    EXPECT_EQ(m.on("mist"), mist) << value;
  }
}

}  // namespace
}  // namespace servogate::plc
