// SPDX-License-Identifier: Apache-2.0
// What the resident control says of its programs: errors, messages, waits, and where they are.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Words : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up();
    shell_.ready();
  }
  /// Loads and starts a program of these blocks.
  void begin(const std::string& name, const std::string& blocks) {
    std::ofstream(shell_.folder() / name) << blocks;
    ASSERT_EQ(shell_.run({"load", (shell_.folder() / name).string()}).exit, 0);
    ASSERT_EQ(shell_.run({"start"}).exit, 0);
  }
  Shell shell_;
};

TEST_F(Words, of_a_program_error_reach_status_and_alarms_with_file_line_and_column) {
  begin("far.nc", "N10 G90 G71 G94\nN20 G1 X5 F6000\nN30 E30=SA20+400\nN40 XE30\nN50 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped_by_alarm"; }));
  const std::string place = (shell_.folder() / "far.nc").string() + ":4:";
  const Outcome alarms = shell_.run({"alarms"});
  EXPECT_TRUE(contains(alarms.out, "program error in line 4: " + place)) << alarms.out;
  EXPECT_TRUE(contains(alarms.out, "X would go to 400, the travel ends at 300 [P701]")) << alarms.out;
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "[P701]"));
  const Outcome russian = shell_.run({"alarms"}, "ru_RU.UTF-8");
  EXPECT_TRUE(contains(russian.out, "ошибка программы, строка 4: " + place)) << russian.out;
  EXPECT_TRUE(contains(russian.out, "ход кончается на 300")) << russian.out;
  const json finding = shell_.status()["alarms"][0]["finding"];
  EXPECT_EQ(finding["code"], "P701");
  EXPECT_EQ(finding["line"], 4);
}

TEST_F(Words, of_the_program_itself_stand_in_the_status_until_the_next_ones) {
  EXPECT_EQ(shell_.status()["message"], "");
  begin("dis.nc", "N10 (DIS,\"CLOSE THE VICE\")\nN20 M0\nN30 (DIS,\"GO\")\nN40 M0\nN50 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "waiting"; }));
  EXPECT_EQ(shell_.status()["message"], "CLOSE THE VICE");
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "message: CLOSE THE VICE"));
  EXPECT_TRUE(contains(shell_.run({"status"}, "ru_RU.UTF-8").out, "сообщение: CLOSE THE VICE"));
  ASSERT_EQ(shell_.run({"start"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["message"] == "GO"; }));
  ASSERT_EQ(shell_.run({"reset"}).exit, 0);
  EXPECT_EQ(shell_.status()["message"], "");
}

TEST_F(Words, of_a_wait_name_signal_value_line_file_and_who_can_end_it) {
  begin("wai.nc", "N10 G0 X1\nN20 (WAI,SA20=1)\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["wait"].is_object() && s["wait"]["for_s"] > 1.0; }));
  const json wait = shell_.status()["wait"];
  EXPECT_EQ(wait["reason"], "signal");
  EXPECT_EQ(wait["symbol"], "cycle_start");
  EXPECT_EQ(wait["place"], "SA20.BL");
  EXPECT_EQ(wait["compare"], "=");
  EXPECT_EQ(wait["wanted"], 1.0);
  EXPECT_EQ(wait["actual"], 0.0);
  EXPECT_EQ(wait["written_by"], "input");
  EXPECT_EQ(wait["line"], 2);
  EXPECT_EQ(wait["file"], (shell_.folder() / "wai.nc").string());
  const std::string sentence = "line 2 of wai.nc: the program waits until cycle_start (SA20.BL) = 1; it is 0";
  for (const char* command : {"status", "alarms"}) {
    const Outcome o = shell_.run({command});
    EXPECT_TRUE(contains(o.out, sentence)) << o.out;
    EXPECT_TRUE(contains(o.out, "servogate input")) << "and what ends it: " << o.out;
  }
  EXPECT_TRUE(contains(shell_.run({"status"}, "ru_RU.UTF-8").out,
                       "строка 2 в wai.nc: программа ждёт, пока cycle_start (SA20.BL) = 1; сейчас 0"));
  EXPECT_EQ(shell_.status()["processes"][0]["wait"]["reason"], "signal");
  // M0 would be one more wait; the button ends this one.
  ASSERT_EQ(shell_.run({"input", "cycle_start", "on"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
  EXPECT_TRUE(shell_.status()["wait"].is_null());
}

TEST_F(Words, of_a_held_feed_name_the_plcs_place_the_operator_or_the_override) {
  begin("long.nc", "N10 G90 G94 G71\nN20 G1 X200 F60\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  EXPECT_TRUE(shell_.status()["wait"].is_null()) << "it moves";
  const auto waits = [&](const char* reason) {
    return shell_.until(
        [reason](const json& s) { return s["wait"].is_object() && s["wait"]["reason"] == reason; });
  };
  ASSERT_EQ(shell_.run({"input", "door_closed", "off"}).exit, 0);
  EXPECT_TRUE(waits("plc_hold")) << shell_.status()["wait"];
  EXPECT_EQ(shell_.status()["wait"]["symbol"], "NC.stop");
  EXPECT_EQ(shell_.status()["wait"]["written_by"], "plc");
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "see in mill.st"));
  ASSERT_EQ(shell_.run({"input", "door_closed", "on"}).exit, 0);
  EXPECT_TRUE(waits("operator_hold")) << "closing the door starts nothing: " << shell_.status()["wait"];
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "`servogate resume` goes on"));
  ASSERT_EQ(shell_.run({"override", "0"}).exit, 0);
  ASSERT_EQ(shell_.run({"resume"}).exit, 0);
  EXPECT_TRUE(waits("override_zero")) << shell_.status()["wait"];
  ASSERT_EQ(shell_.run({"reset"}).exit, 0);
}

TEST_F(Words, of_the_line_go_with_a_reset_and_a_new_program) {
  begin("one.nc", "; comment\nN10 G0 X5\nN20 X6\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
  EXPECT_EQ(shell_.status()["line"], 4);
  EXPECT_EQ(shell_.status()["lines"], 4);
  EXPECT_EQ(shell_.status()["blocks"], 3);
  EXPECT_EQ(shell_.status()["blocks_done"], 3);
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "line 4 of 4, 3 blocks done"));
  std::ofstream(shell_.folder() / "two.nc") << "N10 G0 X1\nN20 M2\n";
  ASSERT_EQ(shell_.run({"load", (shell_.folder() / "two.nc").string()}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["line"] == 0 && s["blocks_done"] == 0; }));
  EXPECT_TRUE(contains(shell_.run({"status"}).out, "two.nc: 2 blocks"));
  ASSERT_EQ(shell_.run({"start", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.status()["line"], 2);
  ASSERT_EQ(shell_.run({"reset"}).exit, 0);
  EXPECT_EQ(shell_.status()["line"], 0);
}

TEST_F(Words, of_an_emergency_stop_while_cutting_stand_under_it) {
  begin("cut.nc", "N10 G90 G94 G71\nN20 G1 X200 F60\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  ASSERT_EQ(shell_.run({"input", "estop_chain_ok", "off"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped_by_alarm"; }));
  const json alarms = shell_.status()["alarms"];
  ASSERT_FALSE(alarms.empty());
  EXPECT_EQ(alarms[0]["number"], 6001);
  for (const json& a : alarms) {
    EXPECT_NE(a["number"], 1010) << "the PLC took the enable away because of the chain";
    EXPECT_EQ(a["first"].get<bool>(), a["sequence"] == a["first_fault"]);
    EXPECT_EQ(a["first_fault"], alarms[0]["sequence"]);
  }
  const std::string out = shell_.run({"alarms"}).out;
  EXPECT_EQ(out.rfind("* 6001 system.emergency_stop", 0), 0u) << out;
  EXPECT_EQ(out.find("\n* "), std::string::npos) << "what follows from it is indented: " << out;
}

TEST(Record, of_a_resident_control_replays_to_its_end) {
  Shell shell;
  const std::string record = (shell.folder() / "up.record").string();
  shell.up("mill", {"--virtual", "--speed", "20", "--record", record});
  shell.ready();
  std::ofstream(shell.folder() / "a.nc") << "N10 G90 G94 G71\nN20 G1 X20 F6000\nN30 M2\n";
  std::ofstream(shell.folder() / "b.nc") << "N10 G0 Y3\nN20 M2\n";
  ASSERT_EQ(shell.run({"load", (shell.folder() / "a.nc").string()}).exit, 0);
  ASSERT_EQ(shell.run({"start", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"mdi", "G0 X7", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"load", (shell.folder() / "b.nc").string()}).exit, 0);
  ASSERT_EQ(shell.run({"start", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"down"}).exit, 0);
  // Without a wait for the control's process: `down` has ended with its record whole.
  const std::string trace = (shell.folder() / "replay.csv").string();
  const Outcome replay = shell.run({"replay", record, "--trace", trace, "--json"});
  EXPECT_EQ(replay.exit, 0) << replay.err;
  EXPECT_EQ(shell.wait(), 0);
  std::ifstream rows(trace);
  std::string last;
  for (std::string row; std::getline(rows, row);) last = row;
  // t, feed, line, X.cmd, X.act, Y.cmd
  std::vector<std::string> cells;
  std::stringstream in(last);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  ASSERT_GT(cells.size(), 5u) << last;
  EXPECT_NEAR(std::stod(cells[3]), 7.0, 0.01) << "the typed block";
  EXPECT_NEAR(std::stod(cells[5]), 3.0, 0.01) << "the second program";
}

}  // namespace
}  // namespace servogate::gateway::testing
