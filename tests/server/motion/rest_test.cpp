// SPDX-License-Identifier: Apache-2.0
// What comes to rest and when: spindles before the control ends, jogs and homing by hold, programs by a limit
// switch, a turning spindle by its chuck.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// Value of a column in the last row of a trace.
double last_of(const std::string& trace, const std::string& column) {
  std::istringstream lines(trace);
  std::string head, row, last;
  std::getline(lines, head);
  while (std::getline(lines, row)) last = row;
  std::istringstream names(head), cells(last);
  for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ',');)
    if (name == column) return std::stod(cell);
  ADD_FAILURE() << "no column " << column;
  return NAN;
}

class Rest : public ::testing::Test {
 protected:
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }
  void mill() {
    shell_.up();
    shell_.ready();
  }
  void load(const std::string& blocks) {
    std::ofstream(file("part.nc")) << blocks;
    ASSERT_EQ(shell_.run({"load", file("part.nc")}).exit, 0);
  }
  bool stands(std::size_t axis) {
    return shell_.until([&](const json& s) { return !s["axes"][axis]["moving"].get<bool>(); });
  }
  Shell shell_;
};

TEST_F(Rest, of_the_spindle_is_waited_for_by_down_and_by_a_signal) {
  for (const bool by_signal : {false, true}) {
    const std::string record = file("up.record"), trace = file("replay.csv");
    Shell shell;
    shell.up("mill", {"--virtual", "--speed", "20", "--record", record});
    shell.ready();
    ASSERT_EQ(shell.run({"mdi", "S4000 M3", "--wait"}).exit, 0);
    EXPECT_GT(shell.status()["spindles"][0]["actual_rpm"], 3900.0);
    if (by_signal) {
      EXPECT_EQ(shell.end(SIGTERM), 0);
    } else {
      ASSERT_EQ(shell.run({"down"}).exit, 0);
      EXPECT_EQ(shell.wait(), 0);
    }
    ASSERT_EQ(shell.run({"replay", record, "--trace", trace}).exit, 0);
    std::stringstream text;
    text << std::ifstream(trace).rdbuf();
    EXPECT_LT(std::abs(last_of(text.str(), "spindle.act")), 30.0) << (by_signal ? "SIGTERM" : "down");
  }
}

TEST_F(Rest, of_the_spindle_is_waited_for_at_the_end_of_a_run_that_leaves_it_turning) {
  std::ofstream(file("spin.nc")) << "N10 S6000 M3\nN20 G0 X5\n";
  const Outcome o = shell_.run({"run", Shell::example("mill/machine.toml"), file("spin.nc"), "--virtual",
                                "--trace", file("t.csv"), "-q"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_LT(std::abs(last_of(shell_.text("t.csv"), "spindle.act")), 30.0);
}

TEST_F(Rest, of_the_spindle_is_waited_for_by_power_off) {
  mill();
  ASSERT_EQ(shell_.run({"mdi", "S4000 M3", "--wait"}).exit, 0);
  EXPECT_FALSE(shell_.status()["spindles"][0]["rests"]);
  const Outcome off = shell_.run({"power", "off"});
  EXPECT_EQ(off.exit, 0) << off.err;
  const json spindle = shell_.status()["spindles"][0];
  EXPECT_TRUE(spindle["rests"]) << spindle;
  EXPECT_LT(std::abs(spindle["actual_rpm"].get<double>()), 30.0);
}

TEST_F(Rest, is_to_be_seen_by_clients_to_its_end_and_nothing_begins_in_it) {
  shell_.up("mill", {"--virtual"});
  shell_.ready();
  ASSERT_EQ(shell_.run({"mdi", "S4000 M3", "--wait"}).exit, 0);
  const pid_t down = shell_.spawn({"down"}, "down");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["spindles"][0]["command_rpm"] < 3900.0; }));
  for (const char* command : {"home", "start", "resume"}) {
    const json refused = shell_.ask({{"cmd", command}});
    EXPECT_EQ(refused["code"], "socket.ending") << command;
  }
  EXPECT_EQ(shell_.ask({{"cmd", "power"}, {"value", 1}})["code"], "socket.ending");
  EXPECT_EQ(shell_.ask({{"cmd", "status"}})["ending"], true);
  EXPECT_EQ(shell_.ask({{"cmd", "down"}})["ok"], true) << "a second one waits for the same end";
  int status = 0;
  waitpid(down, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(shell_.wait(), 0);
}

TEST_F(Rest, comes_by_hold_to_a_jog_and_to_a_homing_too) {
  shell_.up("mill", {"--virtual"});
  ASSERT_EQ(shell_.run({"power", "on"}).exit, 0);
  ASSERT_EQ(shell_.run({"jog", "X", "+200", "--no-wait"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["moving"].get<bool>(); }));
  const Outcome hold = shell_.run({"hold"});
  EXPECT_TRUE(contains(hold.out, "jogging and homing stop")) << hold.out;
  ASSERT_TRUE(stands(0));
  EXPECT_EQ(shell_.status()["axes"][0]["jog_end"]["reason"], "asked");
  ASSERT_EQ(shell_.run({"home"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["homing"].get<bool>(); }));
  EXPECT_TRUE(contains(shell_.run({"hold"}).out, "jogging and homing stop"));
  for (const std::size_t axis : {0u, 1u, 2u}) EXPECT_TRUE(stands(axis));
  const json s = shell_.status();
  EXPECT_FALSE(s["homing"]);
  EXPECT_FALSE(s["axes"][0]["homed"]);
  EXPECT_TRUE(contains(shell_.run({"hold"}).out, "there is nothing to hold"));
}

TEST_F(Rest, comes_to_a_homing_behind_an_open_door_with_an_alarm_that_names_it) {
  shell_.up("mill", {"--virtual"});
  ASSERT_EQ(shell_.run({"power", "on"}).exit, 0);
  const pid_t home = shell_.spawn({"home", "--wait"}, "home");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["homing"].get<bool>(); }));
  ASSERT_EQ(shell_.run({"input", "door_closed", "off"}).exit, 0);
  int status = 0;
  waitpid(home, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const std::string alarms = shell_.run({"alarms"}).out;
  EXPECT_TRUE(contains(alarms, ".feed_enable (in the examples: the door is open)")) << alarms;
}

TEST_F(Rest, comes_to_a_program_when_any_axis_finds_a_limit_switch_whether_that_axis_moves_or_not) {
  const struct {
    const char *name, *blocks, *point, *state;
  } rows[] = {{"at M00", "N10 G0 X10\nN20 M0\nN30 G1 X200 F3000\nN40 M2\n", "y_limit_plus", "waiting"},
              {"an axis at rest", "N10 G1 X200 F60\nN20 M2\n", "y_limit_plus", "running"},
              {"the switch behind", "N10 G1 X200 F60\nN20 M2\n", "x_limit_minus", "running"}};
  mill();
  for (const auto& row : rows) {
    ASSERT_EQ(shell_.run({"mdi", "G0 X0", "--wait"}).exit, 0) << row.name;
    load(row.blocks);
    ASSERT_EQ(shell_.run({"start"}).exit, 0);
    ASSERT_TRUE(shell_.until([&](const json& s) { return s["state"] == row.state; })) << row.name;
    ASSERT_EQ(shell_.run({"input", row.point, "on"}).exit, 0);
    EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped_by_alarm"; })) << row.name;
    EXPECT_TRUE(contains(shell_.run({"alarms"}).out, "limit switch")) << row.name;
    EXPECT_EQ(shell_.run({"start"}).exit, 1) << row.name;
    ASSERT_EQ(shell_.run({"input", row.point, "auto"}).exit, 0);
    ASSERT_EQ(shell_.run({"reset"}).exit, 0);
  }
}

TEST_F(Rest, comes_to_a_lathe_whose_chuck_opens_in_the_cut_and_closing_it_starts_nothing) {
  std::string text = shell_.text(Shell::example("lathe/machine.toml"));
  ASSERT_FALSE(text.empty());
  const std::size_t at = text.find("name = \"");
  text.replace(at, text.find('\n', at) - at, "name = \"Three-axis mill\"");
  const std::size_t logic = text.find("\"lathe.st\"");
  text.replace(logic, 10, "\"" + Shell::example("lathe/lathe.st") + "\"");
  std::ofstream(file("machine.toml")) << text;
  shell_.up_file(file("machine.toml"), {"--virtual", "--speed", "20"});
  shell_.ready();
  load("N10 G90 G94 G71 G97\nN20 S1000 M3\nN30 G1 Z100 F10\nN40 M2\n");
  ASSERT_EQ(shell_.run({"start"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["spindles"][0]["actual_rpm"] > 900.0; }));
  ASSERT_EQ(shell_.run({"input", "chuck_closed", "off"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped_by_alarm"; }));
  EXPECT_TRUE(contains(shell_.run({"alarms"}).out, "706")) << shell_.run({"alarms"}).out;
  EXPECT_TRUE(shell_.until([](const json& s) { return s["spindles"][0]["rests"].get<bool>(); }));
  EXPECT_EQ(shell_.run({"reset"}).exit, 0) << "the part that is lost can be taken out";
  EXPECT_TRUE(shell_.status()["alarms"].empty()) << shell_.status()["alarms"];
  EXPECT_EQ(shell_.run({"mdi", "M69", "--wait"}).exit, 0);
  ASSERT_EQ(shell_.run({"input", "chuck_closed", "on"}).exit, 0);
  const double closed_s = shell_.status()["time_s"];
  ASSERT_TRUE(shell_.until([&](const json& s) { return s["time_s"] > closed_s + 6.0; }));
  EXPECT_TRUE(shell_.status()["spindles"][0]["rests"]);
  EXPECT_FALSE(shell_.status()["axes"][1]["moving"]);
}

}  // namespace
}  // namespace servogate::gateway::testing
