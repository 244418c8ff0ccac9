// SPDX-License-Identifier: Apache-2.0
// A PLC that is held for single scans: nobody looks after the machine, so nothing of it may be on.
#include <gtest/gtest.h>

#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr const char* kDesk = R"(
VAR_GLOBAL scans, divisor : DINT := 1; turns : DINT; late : BOOL; END_VAR
PROGRAM Main
VAR t : TON; quotient, n, done : DINT; END_VAR
MC.estop_ok := estop_chain_ok; MC.power_on := estop_chain_ok;
X.enable := TRUE; Y.enable := TRUE; Z.enable := TRUE;
X.feed_enable := TRUE; Y.feed_enable := TRUE; Z.feed_enable := TRUE;
NC.feed_enable := TRUE; NC.read_in_enable := TRUE; NC.m_ack := NC.m_strobe;
coolant := coolant OR scans > 5;
FOR n := 1 TO turns DO done := done + n; END_FOR;
scans := scans + 1;
t(IN := TRUE, PT := T#1s);
late := t.Q;
quotient := 100 / divisor;
END_PROGRAM
)";

machine::LoadResult machine_with(const Scratch& scratch, const std::string& keys = {}) {
  const std::string path = source("examples/mill/machine.toml");
  std::string text = read_all(path);
  replace(text, "\"mill.st\"]", "\"" + scratch.write("desk.st", kDesk) + "\"]\n" + keys);
  return machine::parse(text, path);
}

class HeldPlc : public ::testing::Test {
 protected:
  HeldPlc() : mill_(machine_with(scratch_), {}) {
    mill_.run(0.5);
    EXPECT_EQ(mill_.ask(RequestKind::reset), Refusal::none);
    EXPECT_TRUE(on("coolant"));
    EXPECT_TRUE(on("MC.estop_ok"));
  }
  bool on(std::string_view symbol) { return mill_.image().packets.bit(place_of(mill_.control(), symbol)); }
  double get(const std::string& name) {
    plc::Engine& engine = mill_.control().logic()->engine();
    return engine.number(*engine.find(name));
  }
  void set(const std::string& name, double value) {
    plc::Engine& engine = mill_.control().logic()->engine();
    image::Packets unused;
    ASSERT_TRUE(engine.set_number(unused, *engine.find(name), value));
  }
  Refusal hold() { return mill_.ask(RequestKind::logic_scan, 1.0); }
  Refusal go() { return mill_.ask(RequestKind::logic_scan, 0.0); }
  Refusal scan(std::uint32_t count) {
    image::Request request;
    request.kind = RequestKind::logic_scan;
    request.value = 2.0;
    request.index = count;
    image::Answer answer;
    EXPECT_TRUE(mill_.control().cycle().post(request));
    mill_.run(0.001);
    EXPECT_TRUE(mill_.control().cycle().take_answer(answer));
    mill_.run(0.001 * (count + 1));
    return static_cast<Refusal>(answer.refusal);
  }
  bool stands(std::string_view symbol) {
    const bool level = on(symbol);
    bool same = true;
    for (int n = 0; n < 200; ++n) {
      mill_.run(0.001);
      same = same && on(symbol) == level;
    }
    return same;
  }

  Scratch scratch_;
  Mill mill_;
};

TEST_F(HeldPlc, has_its_outputs_off_and_its_alarm_on_and_no_sign_of_life) {
  EXPECT_FALSE(stands("control_alive_relay"));
  ASSERT_EQ(hold(), Refusal::none);
  mill_.run(0.01);
  EXPECT_FALSE(on("coolant"));
  EXPECT_FALSE(on("MC.estop_ok"));
  EXPECT_FALSE(on("MC.power_on"));
  EXPECT_FALSE(on("X.enable"));
  EXPECT_FALSE(on("MC.ready"));
  EXPECT_TRUE(stands("control_alive_relay"));
  EXPECT_EQ(mill_.alarms(cycle::alarm::kPlcHeld), 1);
  EXPECT_EQ(mill_.alarms(cycle::alarm::kEmergencyStop), 0) << "nobody has pressed it";
  const double scans = get("scans");
  mill_.run(0.1);
  EXPECT_EQ(get("scans"), scans);
}

TEST_F(HeldPlc, lets_nothing_be_switched_on_or_move) {
  ASSERT_EQ(hold(), Refusal::none);
  EXPECT_EQ(mill_.ask(RequestKind::power, 1.0), Refusal::alarm_active);
  EXPECT_EQ(mill_.ask(RequestKind::home), Refusal::alarm_active);
  EXPECT_EQ(mill_.ask(RequestKind::jog_increment, 1.0, 0), Refusal::alarm_active);
  EXPECT_EQ(mill_.ask(RequestKind::reset), Refusal::none);
  EXPECT_EQ(mill_.ask(RequestKind::power, 1.0), Refusal::alarm_active) << "its cause is still there";
  scan(50);
  mill_.run(1.0);
  for (const char* axis : {"X", "Y", "Z"}) EXPECT_FALSE(mill_.axis(axis).drive_command.power);
}

TEST_F(HeldPlc, runs_so_many_scans_as_are_asked_for_with_its_outputs_as_it_left_them) {
  ASSERT_EQ(hold(), Refusal::none);
  mill_.run(0.01);
  const double scans = get("scans");
  ASSERT_EQ(scan(1), Refusal::none);
  EXPECT_EQ(get("scans"), scans + 1);
  EXPECT_EQ(get("coolant"), 1.0) << "the program sees what it has written";
  EXPECT_FALSE(on("coolant")) << "the machine does not";
  ASSERT_EQ(scan(7), Refusal::none);
  EXPECT_EQ(get("scans"), scans + 8);
  EXPECT_FALSE(on("coolant"));
}

TEST_F(HeldPlc, goes_on_as_if_no_time_had_passed_and_needs_a_reset_before_the_drives_come_on) {
  ASSERT_EQ(hold(), Refusal::none);
  mill_.run(2.0);
  ASSERT_EQ(scan(3), Refusal::none);
  EXPECT_EQ(get("late"), 0.0) << "its timers stood with it";
  ASSERT_EQ(go(), Refusal::none);
  mill_.run(0.003);
  EXPECT_TRUE(on("coolant"));
  EXPECT_TRUE(on("MC.estop_ok"));
  EXPECT_EQ(mill_.alarms(cycle::alarm::kEmergencyStop), 0);
  EXPECT_EQ(get("late"), 0.0);
  EXPECT_EQ(mill_.ask(RequestKind::power, 1.0), Refusal::alarm_active);
  EXPECT_EQ(mill_.ask(RequestKind::reset), Refusal::none);
  mill_.run(1.0);
  EXPECT_EQ(get("late"), 1.0);
  EXPECT_FALSE(stands("control_alive_relay"));
  EXPECT_TRUE(mill_.make_ready()) << mill_.alarm_list();
}

TEST_F(HeldPlc, sees_an_emergency_stop_that_was_pressed_meanwhile) {
  ASSERT_EQ(hold(), Refusal::none);
  mill_.control().world().play_input("estop_chain_ok", {0.0});
  mill_.run(0.1);
  EXPECT_EQ(mill_.alarms(cycle::alarm::kEmergencyStop), 0);
  ASSERT_EQ(go(), Refusal::none);
  mill_.run(0.01);
  EXPECT_EQ(mill_.alarms(cycle::alarm::kEmergencyStop), 1);
}

TEST_F(HeldPlc, names_the_fault_of_a_single_scan) {
  ASSERT_EQ(hold(), Refusal::none);
  mill_.run(0.01);
  set("divisor", 0);
  EXPECT_EQ(mill_.alarms(cycle::alarm::kPlcFault), 0);
  ASSERT_EQ(scan(1), Refusal::none);
  EXPECT_EQ(mill_.alarms(cycle::alarm::kPlcFault), 1);
}

TEST_F(HeldPlc, is_not_held_while_the_drives_are_on) {
  ASSERT_TRUE(mill_.make_ready()) << mill_.alarm_list();
  EXPECT_EQ(hold(), Refusal::drives_on);
  const double scans = get("scans");
  mill_.run(0.1);
  EXPECT_EQ(get("scans"), scans + 100);
  EXPECT_EQ(go(), Refusal::logic_not_held);
  EXPECT_EQ(scan(1), Refusal::logic_not_held);
}

TEST(InstructionBudget, of_the_machine_file_stops_a_scan_that_needs_more) {
  const Scratch scratch;
  for (const bool small : {true, false}) {
    Mill mill(machine_with(scratch, small ? "instruction_budget = 2000" : ""), {});
    mill.run(0.1);
    EXPECT_EQ(mill.alarms(cycle::alarm::kPlcBudget), 0);
    plc::Engine& engine = mill.control().logic()->engine();
    image::Packets unused;
    ASSERT_TRUE(engine.set_number(unused, *engine.find("turns"), 3000));
    mill.run(0.01);
    EXPECT_EQ(mill.alarms(cycle::alarm::kPlcBudget), small ? 1 : 0);
  }
}

}  // namespace
}  // namespace servogate::machine_run
