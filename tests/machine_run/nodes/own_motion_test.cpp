// SPDX-License-Identifier: Apache-2.0
// Drives of the machine that are no csp drives: interpolated position on a path, and an auxiliary axis whose
// drive only answers SDO.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr const char* kSquare =
    "N10 G90 G94 G71\nN20 G1 X80 Y60 F6000\nN30 G2 X80 Y60 I60 J60\nN40 G1 X0 Y0\nN50 M30\n";

/// The greatest following error of X on the program, mm, and where it ended.
struct Followed {
  double worst = 0.0, end = 0.0;
  std::string verdict;
};
Followed run_with(const std::string& device) {
  Mill mill(changed_mill([&](std::string& text) {
              for (const char* node : {"x", "y"})
                replace(text,
                        "name = \"" + std::string(node) + "\"\nid = " + (*node == 'x' ? "1" : "2") +
                            "\ndevice = \"servo-cia402\"",
                        "name = \"" + std::string(node) + "\"\nid = " + (*node == 'x' ? "1" : "2") +
                            "\ndevice = \"" + device + "\"");
            }),
            kSquare);
  EXPECT_TRUE(mill.make_ready()) << mill.alarm_list();
  Followed out;
  mill.after_cycle = [&] { out.worst = std::max(out.worst, std::abs(mill.axis("X").following_error)); };
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.axis("X").command > 50.0; }, 20.0)) << mill.alarm_list();
  EXPECT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 60.0))
      << mill.alarm_list();
  mill.run(0.2);
  out.end = mill.true_position(0);
  out.verdict = mill.judge().verdict();
  return out;
}

TEST(InterpolatedPosition, follows_a_program_as_csp_does) {
  const Followed csp = run_with("servo-cia402"), ip = run_with("servo-cia402-ip");
  EXPECT_GT(csp.worst, 0.0);
  EXPECT_LT(ip.worst, 1.05 * csp.worst + 0.002);
  EXPECT_NEAR(ip.end, csp.end, 0.002);
  EXPECT_EQ(ip.verdict, "");
}

constexpr const char* kTurn = R"(
VAR_GLOBAL on, ref, go : BOOL; END_VAR
PROGRAM Main
VAR p : MC_Power; h : MC_Home; m : MC_MoveAbsolute; END_VAR
MC.estop_ok := estop_chain_ok; MC.power_on := estop_chain_ok;
X.enable := TRUE; X.feed_enable := TRUE; NC.feed_enable := TRUE; NC.read_in_enable := TRUE; NC.m_ack := NC.m_strobe;
U.enable := TRUE; U.feed_enable := magazine_free;
p(Axis := U, Enable := on);
h(Axis := U, Execute := ref);
m(Axis := U, Execute := go, Position := 90.0, Velocity := 60.0);
END_PROGRAM
)";

/// The example magazine whose drum has a drive that only answers SDO.
machine::LoadResult magazine(const Scratch& scratch, bool auxiliary = true) {
  const std::string path = source("examples/magazine/machine.toml");
  std::string text = read_all(path);
  replace(text, "\"magazine.st\"", "\"" + scratch.write("turn.st", kTurn) + "\"");
  replace(text, "name = \"u\"\nid = 2\ndevice = \"servo-cia402\"",
          "name = \"u\"\nid = 2\ndevice = \"positioner-cia402-sdo\"\nsdo_timeout = \"50 ms\"");
  replace(text, "following_error_velocity = \"10 ms\"", "following_error_velocity = \"400 ms\"");
  if (!auxiliary) replace(text, "auxiliary = true", "auxiliary = false");
  return machine::parse(text, path);
}

class Drum : public Scratch, public Mill {
 public:
  Drum() : Mill(magazine(*this), {}) {
    EXPECT_TRUE(until([&] { return axis("X").drive.online && axis("U").drive.online; }, 15.0))
        << alarm_list();
    run(0.1);
    EXPECT_EQ(ask(RequestKind::reset), Refusal::none);
    EXPECT_EQ(ask(RequestKind::power, 1.0), Refusal::none);
    EXPECT_TRUE(until([&] { return axis("X").enabled; }, 5.0));
    set("on");
    EXPECT_TRUE(until([&] { return axis("U").enabled; }, 5.0)) << alarm_list();
    run(0.5);  // until the drive surely holds
    set("ref");
    EXPECT_TRUE(until([&] { return axis("U").homed; }, 30.0)) << alarm_list();
    run(0.2);
  }
  void set(const std::string& name) {
    plc::Engine& engine = control().logic()->engine();
    const auto handle = engine.find(name);
    ASSERT_TRUE(handle) << name;
    image::Packets unused;
    ASSERT_TRUE(engine.set_number(unused, *handle, 1.0)) << name;
  }
};

TEST(DriveBySdo, turns_an_auxiliary_axis_and_is_watched) {
  Drum drum;
  drum.set("go");
  ASSERT_TRUE(drum.until([&] { return drum.axis("U").command == 90.0 && drum.axis("U").in_position; }, 20.0))
      << drum.alarm_list();
  EXPECT_NEAR(drum.true_position(1), 90.0, 0.5);
  EXPECT_EQ(drum.alarm_list(), "");
  drum.inject("can.u", fault::Kind::sdo_silent);
  ASSERT_TRUE(drum.until([&] { return drum.alarms(axis::alarm::kPdoMissing) > 0; }, 0.08))
      << drum.alarm_list();
  for (const image::AlarmRecord& r : drum.control().cycle().alarms().history())
    if (r.number == axis::alarm::kPdoMissing) {
      const std::string words = image::render(r, drum.control().alarm_names(), text::Language::english);
      EXPECT_NE(words.find("(SDO)"), std::string::npos) << words;
      EXPECT_EQ(r.reaction, image::Reaction::stop_on_path);
    }
  EXPECT_FALSE(drum.axis("U").drive.online);
}

TEST(DriveBySdo, is_refused_for_an_axis_of_programs) {
  const Scratch scratch;
  const machine::LoadResult refused = magazine(scratch, false);
  EXPECT_FALSE(refused.ok());
  std::string said;
  for (const text::Finding& f : refused.findings) said += f.str(text::Language::english) + "\n";
  EXPECT_NE(said.find("U: the drive positioner-cia402-sdo only answers SDO"), std::string::npos) << said;
}

}  // namespace
}  // namespace servogate::machine_run
