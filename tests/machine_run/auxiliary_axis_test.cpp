// SPDX-License-Identifier: Apache-2.0
// An axis that the PLC moves with MC_ blocks: the example magazine on its simulated drives, through the one
// gate.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;

constexpr const char* kDesk = R"(
VAR_GLOBAL permit : BOOL := TRUE; crash, on, ref, go, go2, spin, halt, again, free : BOOL; goal, goal2, speed : LREAL := 60.0; way : MC_DIRECTION; END_VAR
PROGRAM Main
VAR p : MC_Power; h : MC_Home; m, n : MC_MoveAbsolute; v : MC_MoveVelocity; s : MC_Stop; r : MC_Reset;
  st : MC_ReadStatus; w : MC_ReadActualPosition; END_VAR
MC.estop_ok := estop_chain_ok; MC.power_on := estop_chain_ok;
X.enable := TRUE; X.feed_enable := TRUE; NC.feed_enable := TRUE; NC.read_in_enable := TRUE; NC.m_ack := NC.m_strobe;
U.enable := permit; U.feed_enable := magazine_free;
p(Axis := U, Enable := on);
h(Axis := U, Execute := ref);
m(Axis := U, Execute := go, Position := goal, Velocity := speed);
n(Axis := U, Execute := go2, Position := goal2, Velocity := speed, Direction := way);
v(Axis := U, Execute := spin, Velocity := -speed, Acceleration := 100.0);
s(Axis := U, Execute := halt);
r(Axis := U, Execute := again);
st(Axis := U, Enable := TRUE);
w(Axis := U, Enable := TRUE);
IF crash THEN goal := 1.0 / goal; END_IF;
END_PROGRAM
)";

machine::LoadResult machine_with(const Scratch& scratch, bool limited = false) {
  const std::string path = source("examples/magazine/machine.toml");
  std::string text = read_all(path);
  replace(text, "\"magazine.st\"", "\"" + scratch.write("desk.st", kDesk) + "\"");
  if (limited) replace(text, "travel_max = \"0 deg\"", "travel_max = \"200 deg\"");
  return machine::parse(text, path);
}

/// The magazine with a PLC program whose wishes the test sets.
class Desk : public Scratch, public Mill {
 public:
  explicit Desk(bool limited = false, std::string_view program = {})
      : Mill(machine_with(*this, limited), program) {
    EXPECT_TRUE(until([&] { return axis("X").drive.online && axis("U").drive.online; }, 15.0));
    run(0.1);
    EXPECT_EQ(ask(RequestKind::reset), Refusal::none);
    EXPECT_EQ(ask(RequestKind::power, 1.0), Refusal::none);
    EXPECT_TRUE(until([&] { return axis("X").enabled; }, 5.0));
  }
  void set(const std::string& name, double value) {
    plc::Engine& engine = control().logic()->engine();
    const auto handle = engine.find(name);
    ASSERT_TRUE(handle) << name;
    image::Packets unused;
    ASSERT_TRUE(engine.set_number(unused, *handle, value)) << name;
  }
  double get(const std::string& name) {
    plc::Engine& engine = control().logic()->engine();
    const auto handle = engine.find(name);
    EXPECT_TRUE(handle) << name;
    return handle ? engine.number(*handle) : std::nan("");
  }
  bool on(const std::string& name) { return get(name) != 0.0; }
  bool comes(const std::string& name, double patience_s = 20.0) {
    return until([&] { return on(name); }, patience_s);
  }
  void pulse(const std::string& name) {
    set(name, 0);
    run(0.003);
    set(name, 1);
  }
  void ready() {
    set("on", 1);
    ASSERT_TRUE(comes("Main.p.Status", 5.0)) << alarm_list();
    set("ref", 1);
    ASSERT_TRUE(comes("Main.h.Done", 30.0)) << alarm_list() << get("Main.h.ErrorID");
    run(0.2);
  }
  void in_motion() {
    ready();
    set("goal", 150.0);
    pulse("go");
    run(1.0);
    ASSERT_TRUE(on("Main.m.Active"));
    ASSERT_NEAR(axis("U").command_velocity, 60.0, 1e-9);
  }
};

TEST(AuxiliaryAxis, is_switched_on_homed_and_moved_by_the_blocks_within_its_limits) {
  Desk desk;
  EXPECT_FALSE(desk.axis("U").enabled) << "the operator's power is for the axes of programs";
  EXPECT_TRUE(desk.on("Main.st.Disabled"));
  desk.ready();
  EXPECT_TRUE(desk.on("Main.st.StandStill"));
  EXPECT_TRUE(desk.axis("U").homed);
  desk.set("goal", 90.0);
  desk.pulse("go");
  ASSERT_TRUE(desk.comes("Main.m.Active", 0.1));
  EXPECT_TRUE(desk.on("Main.st.DiscreteMotion"));
  EXPECT_EQ(desk.axis("U").owner, image::AxisOwner::plc);
  ASSERT_TRUE(desk.comes("Main.m.Done"));
  EXPECT_EQ(desk.axis("U").command, 90.0);
  EXPECT_TRUE(desk.axis("U").in_position);
  EXPECT_NEAR(desk.get("Main.w.Position"), 90.0, 0.05);
  EXPECT_NEAR(desk.true_position(1), 90.0, 0.1);
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, takes_over_from_a_motion_under_way_without_a_jerk) {
  Desk desk;
  desk.in_motion();
  desk.set("goal2", -20.0);
  desk.pulse("go2");
  ASSERT_TRUE(desk.comes("Main.m.CommandAborted", 0.1));
  EXPECT_FALSE(desk.on("Main.m.Done"));
  ASSERT_TRUE(desk.comes("Main.n.Done"));
  EXPECT_EQ(desk.axis("U").command, -20.0);
  EXPECT_EQ(desk.judge().verdict(), "");
}

/// Turns to a place of one turn in a direction and says where it is then.
double turned(Desk& desk, double place, int direction) {
  desk.set("goal2", place);
  desk.set("way", direction);
  desk.pulse("go2");
  EXPECT_TRUE(desk.comes("Main.n.Done")) << place << " by " << direction;
  return desk.axis("U").command;
}

TEST(AuxiliaryAxis, without_ends_turns_in_the_direction_that_is_asked_for) {
  enum { kNone, kUp, kShortest, kDown, kCurrent };
  Desk desk;
  desk.ready();
  EXPECT_EQ(turned(desk, 300.0, kShortest), -60.0);
  EXPECT_EQ(turned(desk, 300.0, kUp), -60.0) << "it stands there already";
  EXPECT_EQ(turned(desk, 300.0, kDown), -60.0);
  EXPECT_EQ(turned(desk, 270.0, kUp), 270.0);
  EXPECT_EQ(turned(desk, 280.0, kDown), -80.0);
  EXPECT_EQ(turned(desk, 270.0, kCurrent), -90.0) << "down, as it turned last";
  EXPECT_EQ(turned(desk, 30.0, kShortest), 30.0) << "120 degrees up";
  EXPECT_EQ(turned(desk, 20.0, kCurrent), 380.0) << "up, as it turned last";
  EXPECT_EQ(turned(desk, -350.0, kShortest), 370.0) << "the place 10";
  EXPECT_EQ(turned(desk, 20.0, kNone), 20.0) << "counting on: a whole turn back";
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, under_way_takes_the_place_that_lies_behind_its_braking_way) {
  enum { kUp = 1, kDown = 3 };
  Desk desk;
  desk.in_motion();  // up at 60 deg/s
  const double here = desk.axis("U").command;
  desk.set("goal2", here + 1.0);
  desk.set("way", kUp);
  desk.pulse("go2");
  ASSERT_TRUE(desk.comes("Main.n.Done"));
  EXPECT_NEAR(desk.axis("U").command, here + 361.0, 1e-9)
      << "1 degree ahead cannot be reached without turning back";
  desk.set("goal", here + 500.0);
  desk.pulse("go");
  desk.run(1.0);
  const double now = desk.axis("U").command;
  desk.set("goal2", now - 1.0);
  desk.set("way", kDown);
  desk.pulse("go2");
  ASSERT_TRUE(desk.comes("Main.n.Done"));
  EXPECT_NEAR(desk.axis("U").command, now - 1.0, 1e-9) << "it turns round and goes down to it";
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, with_ends_takes_no_notice_of_a_direction) {
  Desk desk(true);
  desk.ready();
  EXPECT_EQ(turned(desk, 150.0, 3), 150.0);
}

TEST(AuxiliaryAxis, turns_at_a_speed_until_mc_stop_holds_it) {
  Desk desk;
  desk.ready();
  desk.pulse("spin");
  ASSERT_TRUE(desk.comes("Main.v.InVelocity", 5.0));
  EXPECT_TRUE(desk.on("Main.st.ContinuousMotion"));
  desk.run(5.0);
  EXPECT_NEAR(desk.axis("U").command_velocity, -60.0, 1e-9);
  desk.set("halt", 1);
  ASSERT_TRUE(desk.comes("Main.v.CommandAborted", 0.1));
  EXPECT_TRUE(desk.on("Main.st.Stopping"));
  ASSERT_TRUE(desk.comes("Main.s.Done", 3.0));
  desk.pulse("go");
  ASSERT_TRUE(desk.comes("Main.m.Error", 0.1));
  EXPECT_EQ(desk.get("Main.m.ErrorID"), static_cast<double>(Refusal::axis_stopping));
  desk.set("halt", 0);
  ASSERT_TRUE(desk.comes("Main.st.StandStill", 0.1));
  desk.pulse("go");
  EXPECT_TRUE(desk.comes("Main.m.Done"));
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, stands_on_its_way_while_its_feed_is_not_enabled_and_then_goes_on) {
  Desk desk;
  desk.in_motion();
  desk.control().world().set_input("magazine_free", false);
  ASSERT_TRUE(desk.until([&] { return desk.axis("U").command_velocity == 0.0; }, 2.0));
  const double held = desk.axis("U").command;
  desk.run(3.0);
  EXPECT_EQ(desk.axis("U").command, held);
  EXPECT_TRUE(desk.on("Main.m.Busy"));
  EXPECT_FALSE(desk.on("Main.m.Done"));
  desk.control().world().set_input("magazine_free", true);
  ASSERT_TRUE(desk.comes("Main.m.Done"));
  EXPECT_EQ(desk.axis("U").command, 150.0);
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, loses_its_power_with_the_emergency_stop_and_wants_a_reset_and_a_new_edge) {
  Desk desk;
  desk.in_motion();
  desk.control().world().set_input("estop_chain_ok", false);
  ASSERT_TRUE(desk.comes("Main.m.Error", 0.5));
  EXPECT_EQ(desk.get("Main.m.ErrorID"), cycle::alarm::kEmergencyStop);
  EXPECT_TRUE(desk.on("Main.st.ErrorStop"));
  EXPECT_TRUE(desk.on("Main.p.Error"));
  ASSERT_TRUE(desk.until([&] { return !desk.axis("U").drive_command.power; }, 1.0));
  desk.run(2.0);
  EXPECT_FALSE(desk.axis("U").moving);
  desk.control().world().set_input("estop_chain_ok", true);
  desk.run(0.5);
  EXPECT_FALSE(desk.axis("U").drive_command.power) << "nothing comes on unasked";
  desk.pulse("again");
  ASSERT_TRUE(desk.comes("Main.r.Error", 3.0)) << "the emergency stop is the operator's to acknowledge";
  ASSERT_EQ(desk.ask(RequestKind::reset), Refusal::none);
  desk.run(0.5);
  ASSERT_EQ(desk.ask(RequestKind::power, 1.0), Refusal::none);
  desk.run(0.5);
  EXPECT_FALSE(desk.axis("U").drive_command.power);
  desk.pulse("again");
  ASSERT_TRUE(desk.comes("Main.r.Done", 3.0)) << desk.alarm_list() << desk.get("Main.r.ErrorID");
  desk.pulse("on");
  ASSERT_TRUE(desk.comes("Main.p.Status", 3.0));
  EXPECT_FALSE(desk.axis("U").moving) << "the old order does not come back";
  desk.pulse("go");
  EXPECT_TRUE(desk.comes("Main.m.Done"));
}

TEST(AuxiliaryAxis, whose_enable_is_taken_away_wants_a_new_edge_of_mc_power_at_rest_as_in_motion) {
  for (const bool moving : {false, true}) {
    Desk desk;
    desk.in_motion();
    ASSERT_TRUE(moving || desk.comes("Main.m.Done"));
    desk.set("permit", 0.0);
    ASSERT_TRUE(desk.comes("Main.p.Error", 0.5)) << moving;
    ASSERT_TRUE(desk.until([&] { return !desk.axis("U").drive_command.power; }, 3.0));
    desk.run(0.1);
    EXPECT_EQ(desk.get("Main.p.ErrorID"), moving ? static_cast<double>(axis::alarm::kEnableWithdrawn)
                                                 : static_cast<double>(Refusal::not_powered));
    EXPECT_FALSE(desk.on("Main.p.Status"));
    desk.set("permit", 1.0);
    desk.run(0.5);
    if (moving) {
      desk.pulse("again");
      ASSERT_TRUE(desk.comes("Main.r.Done", 3.0)) << desk.alarm_list();
    }
    desk.run(3.0);
    EXPECT_FALSE(desk.axis("U").drive_command.power) << "nothing comes on unasked";
    EXPECT_TRUE(desk.on("Main.p.Error"));
    desk.pulse("on");
    ASSERT_TRUE(desk.comes("Main.p.Status", 3.0)) << moving;
    EXPECT_FALSE(desk.on("Main.p.Error"));
    desk.pulse("go2");
    EXPECT_TRUE(desk.comes("Main.n.Done")) << desk.alarm_list();
  }
}

TEST(AuxiliaryAxis, may_be_asked_for_power_before_it_is_permitted) {
  Desk desk;
  desk.set("permit", 0.0);
  desk.set("on", 1.0);
  desk.run(1.0);
  EXPECT_FALSE(desk.on("Main.p.Status"));
  EXPECT_FALSE(desk.on("Main.p.Error"));
  desk.set("permit", 1.0);
  EXPECT_TRUE(desk.comes("Main.p.Status", 3.0));
}

TEST(AuxiliaryAxis, stops_with_a_fault_of_its_drive_which_mc_reset_takes_back) {
  Desk desk;
  desk.in_motion();
  fault::Fault fault;
  fault.kind = fault::Kind::emcy;
  fault.error_code = 0x2310;
  desk.control().world().drive("can.u")->inject(fault);
  ASSERT_TRUE(desk.comes("Main.m.Error", 1.0)) << desk.alarm_list();
  EXPECT_GT(desk.get("Main.m.ErrorID"), 1000.0);
  EXPECT_TRUE(desk.on("Main.st.ErrorStop"));
  desk.run(2.0);
  EXPECT_FALSE(desk.axis("U").moving);
  desk.pulse("go2");
  ASSERT_TRUE(desk.comes("Main.n.Error", 0.1));
  EXPECT_EQ(desk.get("Main.n.ErrorID"), static_cast<double>(Refusal::axis_error_stop));
  desk.control().world().drive("can.u")->clear_faults();
  desk.pulse("again");
  ASSERT_TRUE(desk.comes("Main.r.Done", 3.0)) << desk.get("Main.r.ErrorID") << " " << desk.alarm_list();
  EXPECT_FALSE(desk.on("Main.st.ErrorStop"));
  desk.pulse("on");
  ASSERT_TRUE(desk.comes("Main.p.Status", 3.0));
  desk.pulse("go2");
  EXPECT_TRUE(desk.comes("Main.n.Done"));
}

TEST(AuxiliaryAxis, does_not_leave_its_travel) {
  Desk desk(true);
  desk.ready();
  desk.set("goal", 200.5);
  desk.pulse("go");
  ASSERT_TRUE(desk.comes("Main.m.Error", 0.1));
  EXPECT_EQ(desk.get("Main.m.ErrorID"), static_cast<double>(Refusal::outside_travel));
  desk.set("goal", 200.0);
  desk.pulse("go");
  ASSERT_TRUE(desk.comes("Main.m.Done"));
  desk.pulse("spin");
  ASSERT_TRUE(desk.comes("Main.v.Error"));
  EXPECT_EQ(desk.get("Main.v.ErrorID"), static_cast<double>(Refusal::at_soft_limit));
  EXPECT_EQ(desk.axis("U").command, 0.0);
  desk.run(0.01);
  EXPECT_TRUE(desk.on("Main.st.StandStill")) << "no error of the axis";
  EXPECT_EQ(desk.alarms(axis::alarm::kSoftLimitMinus), 0);
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, stops_when_the_operator_stops_and_ends_the_order) {
  Desk desk;
  desk.in_motion();
  ASSERT_EQ(desk.ask(RequestKind::stop), Refusal::none);
  ASSERT_TRUE(desk.comes("Main.m.CommandAborted", 0.1));
  ASSERT_TRUE(desk.until([&] { return !desk.axis("U").moving; }, 2.0));
  EXPECT_LT(desk.axis("U").command, 149.0);
}

TEST(AuxiliaryAxis, stops_and_goes_off_when_the_operator_switches_off_or_the_block_does) {
  for (const bool operators : {true, false}) {
    Desk desk;
    desk.in_motion();
    if (operators)
      ASSERT_EQ(desk.ask(RequestKind::power, 0.0), Refusal::none);
    else
      desk.set("on", 0);
    ASSERT_TRUE(desk.comes(operators ? "Main.m.Error" : "Main.m.CommandAborted", 0.1)) << operators;
    ASSERT_TRUE(desk.until([&] { return !desk.axis("U").drive_command.power; }, 3.0)) << operators;
    EXPECT_FALSE(desk.on("Main.p.Status"));
    desk.run(1.0);
    EXPECT_FALSE(desk.axis("U").moving);
    EXPECT_EQ(desk.judge().verdict(), "");
    EXPECT_EQ(desk.alarms(axis::alarm::kPowerLostInMotion), 0) << desk.alarm_list();
  }
}

TEST(AuxiliaryAxis, is_stopped_by_the_operators_quick_stop_and_stands_in_error) {
  Desk desk;
  desk.in_motion();
  ASSERT_EQ(desk.ask(RequestKind::quick_stop), Refusal::none);
  ASSERT_TRUE(desk.until([&] { return !desk.axis("U").moving; }, 2.0));
  desk.run(0.01);
  EXPECT_TRUE(desk.on("Main.st.ErrorStop"));
  EXPECT_EQ(desk.get("Main.m.ErrorID"), cycle::alarm::kOperatorQuickStop);
}

TEST(AuxiliaryAxis, stops_and_goes_off_when_the_logic_fails) {
  Desk desk;
  desk.in_motion();
  desk.set("goal", 0.0);
  desk.set("crash", 1);
  ASSERT_TRUE(desk.until([&] { return desk.alarms(cycle::alarm::kPlcFault) > 0; }, 0.1));
  for (const image::AlarmRecord& r : desk.control().cycle().alarms().history())
    if (r.number == cycle::alarm::kPlcFault) {
      const std::string words = image::render(r, desk.control().alarm_names(), text::Language::english);
      EXPECT_NE(words.find(".st:"), std::string::npos) << words;
      EXPECT_NE(words.find("divided by zero"), std::string::npos) << words;
    }
  ASSERT_TRUE(desk.until([&] { return !desk.axis("U").drive_command.power; }, 3.0));
  EXPECT_FALSE(desk.axis("U").moving);
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, refuses_a_new_program_of_the_plc_while_it_moves) {
  Desk desk;
  desk.in_motion();
  EXPECT_EQ(desk.ask(RequestKind::logic, 0.0), Refusal::axis_moves);
  desk.run(10.0);
  ASSERT_TRUE(desk.on("Main.m.Done"));
  EXPECT_EQ(desk.ask(RequestKind::logic, 0.0), Refusal::logic_not_changed)
      << "at rest only nothing is prepared";
}

TEST(AuxiliaryAxis, moves_beside_a_program_and_is_no_axis_of_it) {
  Desk desk(false, "N10 G90 G94 G71\nN20 G1 X100 F3000\nN30 X0\nN40 M30\n");
  desk.ready();
  ASSERT_EQ(desk.ask(RequestKind::mode, static_cast<double>(image::Mode::automatic)), Refusal::none);
  desk.set("goal", 150.0);
  desk.pulse("go");
  desk.run(0.2);
  ASSERT_EQ(desk.ask(RequestKind::start), Refusal::none) << "its motion is no obstacle";
  desk.run(1.0);
  ASSERT_EQ(desk.process().state, ProcessState::running) << desk.alarm_list();
  ASSERT_EQ(desk.ask(RequestKind::hold), Refusal::none);
  desk.run(0.5);
  EXPECT_EQ(desk.axis("X").command_velocity, 0.0);
  EXPECT_GT(desk.axis("U").command_velocity, 0.0) << "the operator's feed hold is of the program";
  ASSERT_TRUE(desk.comes("Main.m.Done"));
  ASSERT_EQ(desk.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(desk.until([&] { return desk.process().state == ProcessState::ended; }, 20.0));
  EXPECT_EQ(desk.axis("U").command, 150.0);
  EXPECT_EQ(desk.judge().verdict(), "");
}

TEST(AuxiliaryAxis, of_a_part_program_is_an_unknown_word) {
  const Scratch scratch;
  const std::string nc = scratch.write("u.nc", "N10 G90 G94 G71\nN20 G1 U10 F100\nN30 M30\n");
  const Ending e = servogate({"check", source("examples/magazine/machine.toml"), nc});
  EXPECT_NE(e.code, 0);
  EXPECT_NE((e.out + e.err).find("u.nc:2:"), std::string::npos) << e.out << e.err;
}

TEST(AuxiliaryAxis, of_the_example_turns_the_short_way_to_the_pocket_that_t_names) {
  const std::string folder = source("examples/magazine");
  const Scratch scratch;
  const Ending e = servogate({"run", folder + "/machine.toml", folder + "/pockets.nc", "--virtual", "--trace",
                              scratch.path("t.csv")});
  EXPECT_EQ(e.code, 0) << e.out << e.err;
  const TraceFile trace(scratch.path("t.csv"));
  const std::size_t u = trace.column("U.cmd");
  double most = 0.0;
  for (std::size_t row = 0; row < trace.rows(); ++row) most = std::max(most, trace.at(row, u));
  EXPECT_NEAR(most, 60.0, 0.1) << "pocket 3";
  EXPECT_NEAR(trace.at(trace.rows() - 1, u), -30.0, 0.1) << "pocket 12 is one to the left of pocket 1";
}

}  // namespace
}  // namespace servogate::machine_run
