// SPDX-License-Identifier: Apache-2.0
// Commands that wait for what they began: until when, what they say, and what Ctrl-C does meanwhile.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/comes.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

bool all_on(const json& status) {
  for (const json& a : status["axes"])
    if (!a["enabled"].get<bool>()) return false;
  return true;
}

TEST(Power, is_on_when_the_command_has_ended_brakes_included) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "2"});
  const Outcome on = shell.run({"power", "on"});
  EXPECT_EQ(on.exit, 0) << on.err;
  EXPECT_NE(on.out.find("the drives are on"), std::string::npos) << on.out;
  EXPECT_TRUE(all_on(shell.status()));
  const Outcome home = shell.run({"home", "Z", "Z"});
  EXPECT_EQ(home.exit, 0) << "the axis with the brake is ready at once";
  EXPECT_EQ(home.out, "homing Z\n") << "an axis named twice is homed once";
  ASSERT_TRUE(shell.until([](const json& s) { return !s["homing"].get<bool>(); }));
  EXPECT_EQ(shell.run({"power", "off"}).exit, 0);
  EXPECT_FALSE(shell.status()["axes"][2]["enabled"].get<bool>());
}

/// The example mill with this cycle in real time, its drives on.
void up_at(Shell& shell, const std::string& cycle_time) {
  std::ifstream in(Shell::example("mill/machine.toml"));
  std::string machine((std::istreambuf_iterator<char>(in)), {});
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"\"1 ms\"", "\"" + cycle_time + "\""},
                                 {"\"mill.st\"", "\"" + Shell::example("mill/mill.st") + "\""}}) {
    const std::size_t at = machine.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    machine.replace(at, from.size(), to);
  }
  // A longer cycle notices the switch later: what is before the mechanical end asks for a slower search.
  const std::string fast = "fast = \"50 mm/s\"";
  for (std::size_t at = 0; (at = machine.find(fast, at)) != std::string::npos;)
    machine.replace(at, fast.size(), "fast = \"40 mm/s\"");
  std::ofstream(shell.folder() / "slow.toml") << machine;
  shell.up_file((shell.folder() / "slow.toml").string(), {"--realtime=best-effort"});
  ASSERT_EQ(shell.run({"power", "on"}).exit, 0);
}

TEST(Home, waits_for_all_axes_with_a_long_cycle_too) {
  for (const char* cycle_time : {"15 ms", "20 ms"}) {
    Shell shell;
    up_at(shell, cycle_time);
    const Outcome home = shell.run({"home", "--wait"});
    EXPECT_EQ(home.exit, 0) << cycle_time << ": " << home.err << home.out << shell.run({"alarms"}).out;
    for (const json& a : shell.status()["axes"])
      EXPECT_TRUE(a["homed"].get<bool>()) << cycle_time << ": " << a["letter"];
  }
}

TEST(Power, does_not_wait_when_it_is_told_so) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "0.05"});
  const Outcome on = shell.run({"power", "on", "--no-wait"});
  EXPECT_EQ(on.exit, 0) << on.err;
  EXPECT_NE(on.out.find("the drives are being switched on"), std::string::npos) << on.out;
  EXPECT_FALSE(all_on(shell.status())) << "at a twentieth of real time the brake takes seconds";
}

TEST(Power, that_does_not_come_names_the_axes_and_the_states_of_their_drives) {
  Shell shell;
  // A PLC that never permits the power.
  std::ifstream in(Shell::example("mill/machine.toml"));
  std::string machine((std::istreambuf_iterator<char>(in)), {});
  const std::size_t at = machine.find("\"mill.st\"");
  ASSERT_NE(at, std::string::npos);
  machine.replace(at, 9, "\"off.st\"");
  std::ofstream(shell.folder() / "machine.toml") << machine;
  std::ofstream(shell.folder() / "off.st")
      << "PROGRAM Off\nMC.estop_ok := TRUE;\nMC.power_on := FALSE;\nEND_PROGRAM\n";
  const pid_t up =
      shell.spawn({"up", (shell.folder() / "machine.toml").string(), "--virtual", "--speed", "20"}, "up");
  ASSERT_TRUE(shell.until([](const json& s) { return s.contains("axes"); }));
  const Outcome on = shell.run({"power", "on"});
  EXPECT_EQ(on.exit, 1);
  EXPECT_NE(on.err.find("not switched on within 15 s: X ("), std::string::npos) << on.err;
  EXPECT_NE(on.err.find("Z ("), std::string::npos) << on.err;
  kill(up, SIGTERM);
  EXPECT_EQ(ending_of(up), 0);
}

class Program : public ::testing::Test {
 protected:
  Program() {
    shell_.up("mill", {"--virtual", "--speed", "5"});
    shell_.ready();
    std::ofstream(shell_.folder() / "long.nc") << "N10 G1 X200 F1000\nN20 X-200\nN30 M2\n";
    EXPECT_EQ(shell_.run({"load", (shell_.folder() / "long.nc").string()}).exit, 0);
  }
  /// `start --wait` while the program moves.
  pid_t started() {
    const pid_t client = shell_.spawn({"start", "--wait"}, "start");
    EXPECT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 100.0; }));
    return client;
  }
  Shell shell_;
};

TEST_F(Program, is_held_on_its_path_by_Ctrl_C_in_start_wait_and_can_go_on) {
  const pid_t client = started();
  kill(client, SIGINT);
  EXPECT_EQ(ending_of(client), 3);
  const json held = shell_.status();
  EXPECT_EQ(held["state"], "held");
  EXPECT_EQ(held["feed_mm_min"], 0.0) << "it stands when the command has ended";
  EXPECT_NE(shell_.text("start.err").find("`servogate resume` goes on"), std::string::npos)
      << shell_.text("start.err");
  EXPECT_EQ(shell_.run({"resume"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
  EXPECT_NEAR(shell_.status()["axes"][0]["command"].get<double>(), -200.0, 1e-6);
}

TEST_F(Program, is_ended_by_a_second_Ctrl_C) {
  const pid_t client = started();
  kill(client, SIGINT);
  kill(client, SIGTERM);
  EXPECT_EQ(ending_of(client), 3);
  EXPECT_EQ(shell_.status()["state"], "idle");
}

class Stops : public ::testing::Test {
 protected:
  Stops() {
    shell_.up();
    shell_.ready();
  }
  void load(const std::string& blocks) {
    std::ofstream(shell_.folder() / "stops.nc") << blocks;
    ASSERT_EQ(shell_.run({"load", (shell_.folder() / "stops.nc").string()}).exit, 0);
  }
  bool waits(const char* reason) {
    return shell_.until(
        [&](const json& s) { return s["wait"].is_object() && s["wait"]["reason"] == reason; });
  }
  Shell shell_;
};

TEST_F(Stops, that_the_program_asks_for_end_start_wait_and_say_what_goes_on) {
  load("N10 G1 X5 F6000\nN20 M0\nN30 X10\nN40 M2\n");
  const Outcome o = shell_.run({"start", "--wait"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_NE(
      o.err.find(
          "line 2 of stops.nc: the program stands at M00 until the operator's start\n    `servogate start`"),
      std::string::npos)
      << o.err;
  const json stands = shell_.status();
  EXPECT_EQ(stands["state"], "waiting");
  EXPECT_EQ(stands["axes"][0]["command"], 5.0);
  EXPECT_EQ(shell_.run({"start", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.status()["state"], "ended") << "the second one waits for the end, not for the same M00";
}

TEST_F(Stops, that_the_program_asks_for_end_step_wait) {
  load("N10 G1 X5 F6000\nN20 M0\nN30 X10\nN40 M2\n");
  ASSERT_EQ(shell_.run({"step", "--wait"}).exit, 0);
  const Outcome o = shell_.run({"step", "--wait"}, "ru_RU.UTF-8");
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_NE(o.err.find("стоит на M00 до пуска оператором"), std::string::npos) << o.err;
  EXPECT_EQ(shell_.run({"step", "--wait"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["command"] == 10.0; }));
}

TEST_F(Stops, of_a_typed_block_are_gone_on_from_as_that_block_and_not_as_the_loaded_program) {
  ASSERT_EQ(shell_.run({"mdi", "M0", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.run({"start"}).out, "the typed block goes on: M0\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
  ASSERT_EQ(shell_.run({"mdi", "M0", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.run({"start"}, "ru_RU.UTF-8").out, "введённый кадр продолжается: M0\n");
}

TEST_F(Stops, behind_a_step_are_left_by_start_which_runs_on_to_the_end) {
  load("N10 G1 X5 F6000\nN20 X10\nN30 X15\nN40 X20\nN50 M2\n");
  ASSERT_EQ(shell_.run({"step", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.status()["axes"][0]["command"], 5.0);
  EXPECT_EQ(shell_.run({"start", "--wait"}).exit, 0);
  EXPECT_EQ(shell_.status()["state"], "ended");
  EXPECT_EQ(shell_.status()["axes"][0]["command"], 20.0);
}

TEST_F(Stops, of_a_typed_block_are_resumed_as_that_block) {
  ASSERT_EQ(shell_.run({"mdi", "G1 X200 F60"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  ASSERT_EQ(shell_.run({"hold"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "held"; }));
  EXPECT_EQ(shell_.run({"resume"}).out, "the typed block goes on: G1 X200 F60\n");
  ASSERT_EQ(shell_.run({"reset"}).exit, 0);
}

TEST_F(Stops, of_a_typed_block_end_mdi_wait) {
  const Outcome o = shell_.run({"mdi", "M0", "--wait"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_NE(o.err.find("stands at M00"), std::string::npos) << o.err;
}

TEST_F(Stops, that_others_cause_are_said_while_the_command_goes_on_waiting) {
  load("N10 G1 X200 F60\nN20 (WAI,SA20=1)\nN30 M2\n");
  const pid_t client = shell_.spawn({"start", "--wait"}, "start");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  ASSERT_EQ(shell_.run({"hold"}).exit, 0);
  const auto said = [&](const std::string& words) {
    return shell_.until(
        [&](const json&) { return shell_.text("start.err").find(words) != std::string::npos; });
  };
  EXPECT_TRUE(said(
      "is held by a feed hold of the operator or the PLC; still waiting\n    `servogate resume` goes on."))
      << shell_.text("start.err");
  ASSERT_EQ(shell_.run({"resume"}).exit, 0);
  ASSERT_EQ(shell_.run({"input", "door_closed", "off"}).exit, 0);
  EXPECT_TRUE(said("is held by the PLC: NC.stop")) << shell_.text("start.err");
  ASSERT_EQ(shell_.run({"input", "door_closed", "on"}).exit, 0);
  ASSERT_TRUE(waits("operator_hold"));
  ASSERT_EQ(shell_.run({"resume"}).exit, 0);
  ASSERT_TRUE(waits("signal"));
  EXPECT_TRUE(said("the program waits until cycle_start (SA20.BL) = 1; it is 0; still waiting"))
      << shell_.text("start.err");
  ASSERT_EQ(shell_.run({"input", "cycle_start", "on"}).exit, 0);
  EXPECT_EQ(ending_of(client), 0) << shell_.text("start.err");
  EXPECT_EQ(shell_.status()["state"], "ended");
}

TEST_F(Program, that_still_stops_after_a_reset_says_so_to_who_loads_or_types_meanwhile) {
  const std::string path = (shell_.folder() / "fast.nc").string();
  std::ofstream(path) << "N10 G0 X200\nN20 X-200\nN30 M2\n";
  const json load{{"cmd", "load"}, {"program", path}}, mdi{{"cmd", "mdi"}, {"block", "G0 X0"}};
  ASSERT_EQ(shell_.ask(load)["ok"], true);
  json loaded, typed;
  // It stands after a tenth of a second; a computer that was elsewhere then asks once more.
  EXPECT_TRUE(tests::comes([&] {
    EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "idle" || s["state"] == "ended"; }));
    EXPECT_EQ(shell_.ask({{"cmd", "start"}})["ok"], true);
    json s;
    EXPECT_TRUE(shell_.until([&](const json& now) {
      s = now;
      return s["feed_mm_min"] > 25'000.0 || s["state"] == "ended";
    }));
    const json running = shell_.ask(load);
    EXPECT_EQ(shell_.ask({{"cmd", "reset"}})["ok"], true);
    loaded = shell_.ask(load);
    typed = shell_.ask(mdi);
    return running["text"] == "a program runs: end it first (`servogate reset`)" &&
           loaded.value("text", "") == typed.value("text", "") &&
           typed.value("code", "") == "gate.program_stopping";
  }));
  EXPECT_EQ(loaded["text"], "the program is still stopping: ask again once the axes stand");
  EXPECT_EQ(typed["text"], loaded["text"]);
}

TEST_F(Program, goes_on_when_its_client_is_killed) {
  const pid_t client = started();
  kill(client, SIGKILL);
  ending_of(client);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
}

TEST(Homing, is_stopped_by_Ctrl_C) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "2"});
  ASSERT_EQ(shell.run({"power", "on"}).exit, 0);
  const pid_t client = shell.spawn({"home", "--wait"}, "home");
  ASSERT_TRUE(shell.until([](const json& s) { return s["homing"].get<bool>(); }));
  kill(client, SIGINT);
  EXPECT_EQ(ending_of(client), 3);
  EXPECT_FALSE(shell.status()["homing"].get<bool>());
}

}  // namespace
}  // namespace servogate::gateway::testing
