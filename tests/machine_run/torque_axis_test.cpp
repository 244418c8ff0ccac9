// SPDX-License-Identifier: Apache-2.0
// An auxiliary axis that the PLC leads by torque with MC_TorqueControl: the example magazine's U as a clamp
// on a simulated drive in profile torque or in cyclic torque.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr const char* kClamp = R"(
VAR_GLOBAL on, ref, go, clamp, halt, again : BOOL; torque : LREAL := 20.0; ramp : LREAL := 50.0; speed : LREAL := 60.0;
END_VAR
PROGRAM Main
VAR p : MC_Power; h : MC_Home; m : MC_MoveAbsolute; t : MC_TorqueControl; s : MC_Stop; r : MC_Reset;
  st : MC_ReadStatus; a : MC_ReadActualTorque; END_VAR
MC.estop_ok := estop_chain_ok; MC.power_on := estop_chain_ok;
X.enable := TRUE; X.feed_enable := TRUE; NC.feed_enable := TRUE; NC.read_in_enable := TRUE; NC.m_ack := NC.m_strobe;
U.enable := TRUE; U.feed_enable := magazine_free;
p(Axis := U, Enable := on);
h(Axis := U, Execute := ref);
m(Axis := U, Execute := go, Position := 50.0, Velocity := 60.0);
t(Axis := U, Execute := clamp, Torque := torque, TorqueRamp := ramp, Velocity := speed);
s(Axis := U, Execute := halt);
r(Axis := U, Execute := again);
st(Axis := U, Enable := TRUE);
a(Axis := U, Enable := TRUE);
END_PROGRAM
)";

struct Machine {
  std::string mode = "tq";
  double stop_at = 100.0;  ///< rigid stop in degrees
  bool limited = false;    ///< travel to 90 degrees
  double torque_max = 30.0;
};

machine::LoadResult machine_with(const Scratch& scratch, const Machine& wanted) {
  const std::string path = source("examples/magazine/machine.toml");
  std::string text = read_all(path);
  replace(text, "\"magazine.st\"", "\"" + scratch.write("clamp.st", kClamp) + "\"");
  replace(text, "name = \"u\"\nid = 2\ndevice = \"servo-cia402\"",
          "name = \"u\"\nid = 2\ndevice = \"servo-cia402-torque\"");
  if (wanted.torque_max > 0.0)
    replace(text, "auxiliary = true\n",
            "auxiliary = true\ntorque_max = \"" + std::to_string(wanted.torque_max) +
                " %\"\ntorque_ramp = 100\n");
  if (wanted.limited) {
    replace(text, "travel_min = \"0 deg\"", "travel_min = \"-10 deg\"");
    replace(text, "travel_max = \"0 deg\"", "travel_max = \"90 deg\"");
  }
  replace(
      text, "start = \"12 deg\"\n",
      "start = \"12 deg\"\ninertia = \"0.002 kg m2\"\nfriction_coulomb = \"0.05 N m\"\nend_stop_max = \"" +
          std::to_string(wanted.stop_at) + " deg\"\n");
  machine::LoadResult loaded = machine::parse(text, path);
  if (wanted.mode == "cst")
    loaded.devices.at("servo-cia402-torque").behaviour.torque_mode = machine::TorqueMode::cst;
  return loaded;
}

class Clamp : public Scratch, public Mill {
 public:
  explicit Clamp(const Machine& wanted = {}) : Mill(machine_with(*this, wanted), {}) {
    EXPECT_TRUE(until([&] { return axis("X").drive.online && axis("U").drive.online; }, 15.0))
        << alarm_list();
    run(0.1);
    EXPECT_EQ(ask(RequestKind::reset), Refusal::none);
    EXPECT_EQ(ask(RequestKind::power, 1.0), Refusal::none);
    EXPECT_TRUE(until([&] { return axis("X").enabled; }, 5.0));
    set("on", 1);
    EXPECT_TRUE(comes("Main.p.Status", 5.0)) << alarm_list();
    set("ref", 1);
    EXPECT_TRUE(comes("Main.h.Done", 30.0)) << alarm_list();
    run(0.2);
    after_cycle = [this] {
      fastest = std::max(fastest, std::abs(control().world().drive("can.u")->velocity_counts_s()));
    };
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
  /// Greatest speed of the drive so far, degrees a second.
  double fastest_deg_s() const { return fastest / 65536.0 / 20.0 * 360.0; }
  std::int64_t object(std::uint16_t index) { return control().world().drive("can.u")->object(index); }
  double fastest = 0.0;
};

void clamps_and_lets_go(const std::string& mode, int mode_number) {
  Machine wanted;
  wanted.mode = mode;
  Clamp clamp(wanted);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.Active", 0.1)) << clamp.get("Main.t.ErrorID");
  EXPECT_TRUE(clamp.on("Main.st.ContinuousMotion"));
  ASSERT_TRUE(clamp.comes("Main.t.InTorque", 10.0)) << clamp.alarm_list();
  clamp.run(1.0);
  EXPECT_TRUE(clamp.on("Main.t.InTorque")) << clamp.alarm_list();
  EXPECT_EQ(clamp.object(0x6061), mode_number);
  EXPECT_NEAR(clamp.get("Main.a.Torque"), 20.0, 1.0);
  EXPECT_NEAR(clamp.true_position(1), 100.0, 0.5) << "held against the stop";
  EXPECT_LT(clamp.fastest_deg_s(), 1.2 * 60.0);
  clamp.set("halt", 1);
  ASSERT_TRUE(clamp.comes("Main.t.CommandAborted", 0.2));
  clamp.run(0.2);
  EXPECT_GT(clamp.object(0x6071), 50) << "down in a ramp, not at once";
  ASSERT_TRUE(clamp.comes("Main.s.Done", 3.0)) << clamp.alarm_list();
  EXPECT_EQ(clamp.object(0x6061), 8);
  EXPECT_EQ(clamp.object(0x6071), 0);
  clamp.set("halt", 0);
  ASSERT_TRUE(clamp.comes("Main.st.StandStill", 0.5));
  clamp.set("go", 1);
  ASSERT_TRUE(clamp.comes("Main.m.Done", 10.0)) << clamp.alarm_list();
  EXPECT_NEAR(clamp.true_position(1), 50.0, 0.1);
  EXPECT_EQ(clamp.alarms(axis::alarm::kFollowingError), 0);
}

TEST(TorqueControl, clamps_with_its_torque_and_goes_back_to_positions_in_profile_torque) {
  clamps_and_lets_go("tq", 4);
}

TEST(TorqueControl, does_the_same_in_cyclic_torque) { clamps_and_lets_go("cst", 10); }

TEST(TorqueControl, has_its_slope_and_the_speed_limit_written_into_the_drive) {
  Clamp clamp;
  EXPECT_EQ(clamp.object(0x6087), 1000) << "100 % a second in per mille";
  EXPECT_EQ(clamp.object(0x6088), 0);
  EXPECT_EQ(clamp.object(0x6080), 780) << "180 degrees a second behind 20 to 1 are 600 rpm, and 30 % more";
}

TEST(TorqueControl, keeps_to_its_speed_while_nothing_holds_the_axis) {
  Machine free;
  free.stop_at = 1e5;
  Clamp clamp(free);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.Active", 0.1));
  clamp.run(5.0);
  EXPECT_TRUE(clamp.on("Main.t.Active")) << clamp.alarm_list();
  EXPECT_FALSE(clamp.on("Main.t.InTorque"));
  EXPECT_GT(clamp.fastest_deg_s(), 30.0);
  EXPECT_LT(clamp.fastest_deg_s(), 1.2 * 60.0);
}

TEST(TorqueControl, that_runs_away_is_an_alarm_and_a_controlled_stop_in_position_mode) {
  Machine free;
  free.stop_at = 1e5;
  Clamp clamp(free);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.Active", 0.1));
  clamp.run(1.0);
  clamp.control().world().drive("can.u")->set_load_torque(-1.0);  // pulls towards plus
  ASSERT_TRUE(clamp.comes("Main.t.Error", 2.0)) << clamp.alarm_list();
  EXPECT_EQ(clamp.get("Main.t.ErrorID"), axis::alarm::kTorqueTooFast);
  EXPECT_EQ(clamp.alarms(axis::alarm::kTorqueTooFast), 1);
  ASSERT_TRUE(clamp.until([&] { return !clamp.axis("U").moving; }, 3.0)) << clamp.alarm_list();
  const double stood = clamp.true_position(1);
  EXPECT_TRUE(clamp.axis("U").enabled);
  EXPECT_EQ(clamp.object(0x6061), 8);
  clamp.run(1.0);
  EXPECT_NEAR(clamp.true_position(1), stood, 1.0) << "held against the load";
  EXPECT_TRUE(clamp.on("Main.st.ErrorStop"));
  EXPECT_EQ(clamp.alarms(axis::alarm::kFollowingError), 0) << clamp.alarm_list();
}

TEST(TorqueControl, stops_before_the_end_of_its_travel) {
  Machine limited;
  limited.limited = true;
  Clamp clamp(limited);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.Error", 10.0)) << clamp.alarm_list();
  EXPECT_EQ(clamp.get("Main.t.ErrorID"), axis::alarm::kSoftLimitPlus);
  ASSERT_TRUE(clamp.until([&] { return !clamp.axis("U").moving; }, 3.0)) << clamp.alarm_list();
  EXPECT_LT(clamp.true_position(1), 91.0);
  EXPECT_GT(clamp.true_position(1), 80.0);
}

TEST(TorqueControl, ends_when_a_motion_takes_over_and_when_the_power_is_taken) {
  Clamp clamp;
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.InTorque", 10.0)) << clamp.alarm_list();
  clamp.set("go", 1);
  ASSERT_TRUE(clamp.comes("Main.t.CommandAborted", 0.1));
  ASSERT_TRUE(clamp.comes("Main.m.Done", 10.0)) << clamp.alarm_list();
  EXPECT_NEAR(clamp.true_position(1), 50.0, 0.1);
  clamp.set("clamp", 0);
  clamp.run(0.01);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.InTorque", 10.0)) << clamp.alarm_list();
  clamp.set("on", 0);
  ASSERT_TRUE(clamp.until([&] { return !clamp.axis("U").drive_command.power; }, 3.0)) << clamp.alarm_list();
  EXPECT_EQ(clamp.object(0x6071), 0);
  EXPECT_TRUE(clamp.on("Main.t.CommandAborted"));
}

TEST(TorqueControl, has_no_torque_while_the_feed_is_not_enabled) {
  Clamp clamp;
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.InTorque", 10.0)) << clamp.alarm_list();
  clamp.control().world().set_input("magazine_free", false);
  ASSERT_TRUE(clamp.until([&] { return clamp.object(0x6071) == 0; }, 2.0));
  EXPECT_TRUE(clamp.on("Main.t.Active"));
  EXPECT_FALSE(clamp.on("Main.t.InTorque"));
  clamp.control().world().set_input("magazine_free", true);
  EXPECT_TRUE(clamp.comes("Main.t.InTorque", 2.0)) << clamp.alarm_list();
}

TEST(TorqueControl, is_refused_beyond_its_limits_and_on_an_axis_without_torque) {
  Clamp clamp;
  const auto refused = [](Clamp& c, double torque, double ramp, double speed) {
    c.set("torque", torque);
    c.set("ramp", ramp);
    c.set("speed", speed);
    c.set("clamp", 0);
    c.run(0.01);
    c.set("clamp", 1);
    EXPECT_TRUE(c.comes("Main.t.Error", 0.1));
    return static_cast<Refusal>(c.get("Main.t.ErrorID"));
  };
  EXPECT_EQ(refused(clamp, -31.0, 50.0, 60.0), Refusal::torque_range);
  EXPECT_EQ(refused(clamp, 20.0, 101.0, 60.0), Refusal::torque_ramp_range);
  EXPECT_EQ(refused(clamp, 20.0, 50.0, 0.0), Refusal::velocity_range);
  EXPECT_EQ(clamp.object(0x6061), 8);
  Machine without;
  without.torque_max = 0.0;
  Clamp other(without);
  EXPECT_EQ(refused(other, 20.0, 50.0, 60.0), Refusal::no_torque);
}

TEST(TorqueControl, of_a_drive_that_does_not_take_the_mode_is_an_alarm) {
  Clamp clamp;
  fault::Fault fault;
  fault.kind = fault::Kind::sdo_abort;
  fault.index = 0x6060;
  clamp.control().world().drive("can.u")->inject(fault);
  clamp.set("clamp", 1);
  ASSERT_TRUE(clamp.comes("Main.t.Error", 3.0)) << clamp.alarm_list();
  EXPECT_EQ(clamp.get("Main.t.ErrorID"), axis::alarm::kTorqueModeRefused);
}

}  // namespace
}  // namespace servogate::machine_run
