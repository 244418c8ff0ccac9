// SPDX-License-Identifier: Apache-2.0
// The resident control as people use it: the commands of the shell, their words and their exit codes.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

double position(const json& status, std::size_t axis) { return status["axes"][axis]["command"]; }

TEST(Commands, say_that_no_control_runs_and_exit_with_4) {
  Shell shell;
  for (const char* command : {"status", "start", "hold", "alarms", "down"}) {
    const Outcome o = shell.run({command});
    EXPECT_EQ(o.exit, 4) << command;
    EXPECT_TRUE(contains(o.err, "no control is running")) << o.err;
  }
  EXPECT_TRUE(contains(shell.run({"status"}, "ru_RU.UTF-8").err, "управление не запущено"));
}

TEST(Commands, exit_with_2_where_they_are_used_wrongly) {
  Shell shell;
  shell.up();
  const std::vector<std::vector<std::string>> wrong = {{"jog", "X"},
                                                       {"jog", "X", "far"},
                                                       {"jog", "X", "1deg"},
                                                       {"jog", "Q", "+1mm"},
                                                       {"zero"},
                                                       {"zero", "X", "y"},
                                                       {"override", "fast"},
                                                       {"power", "maybe"},
                                                       {"mdi", " "},
                                                       {"home", "X", "Q"},
                                                       {"input", "nothing", "on"},
                                                       {"input", "lamp_red", "on"},
                                                       {"input", "door_closed", "auto"},
                                                       {"input", "door_closed"},
                                                       {"no-such-command"}};
  for (const auto& arguments : wrong) EXPECT_EQ(shell.run(arguments).exit, 2) << arguments.back();
  EXPECT_TRUE(contains(shell.run({"jog", "X", "1deg"}).err, "'deg' is not the unit of X"));
  EXPECT_TRUE(contains(shell.run({"jog", "Q", "+1mm"}).err, "it has X, Y, Z"));
}

TEST(Commands, refuse_with_a_sentence_in_the_language_of_who_asks) {
  Shell shell;
  shell.up();
  const Outcome english = shell.run({"jog", "X", "+1mm"});
  EXPECT_EQ(english.exit, 1);
  EXPECT_TRUE(contains(english.err, "X is not ready: switch the drives on first")) << english.err;
  const Outcome russian = shell.run({"jog", "X", "+1mm"}, "ru_RU.UTF-8");
  EXPECT_TRUE(contains(russian.err, "сначала включите приводы")) << russian.err;
  const Outcome json_answer = shell.run({"jog", "X", "+1mm", "--json"});
  EXPECT_EQ(json::parse(json_answer.out)["code"], "gate.not_powered");
  EXPECT_EQ(shell.run({"start"}).exit, 1);
  EXPECT_TRUE(contains(shell.run({"start"}).err, "no program is loaded"));
}

TEST(Commands, switch_on_jog_with_a_leading_minus_and_switch_off) {
  Shell shell;
  shell.up();
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  EXPECT_EQ(shell.run({"jog", "X", "+1mm", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), 1.0, 1e-9);
  EXPECT_EQ(shell.run({"jog", "X", "-3mm", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), -2.0, 1e-9);
  EXPECT_EQ(shell.run({"jog", "X", "-.5", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), -2.5, 1e-9);
  EXPECT_EQ(shell.run({"power", "off", "--wait"}).exit, 0);
  EXPECT_FALSE(shell.status()["axes"][0]["enabled"].get<bool>());
}

TEST(Commands, home_the_named_axes_only_and_show_it_in_the_status) {
  Shell shell;
  shell.up("mill", {"--virtual"});
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  // By the socket: a process may begin later on a busy computer than a homing takes.
  ASSERT_TRUE(shell.ask({{"cmd", "home"}, {"axes", {"X", "Y"}}})["ok"].get<bool>());
  EXPECT_TRUE(shell.ask({{"cmd", "status"}})["homing"].get<bool>());
  EXPECT_FALSE(shell.ask({{"cmd", "home"}, {"axes", {"Z"}}})["ok"].get<bool>());
  ASSERT_TRUE(shell.until([](const json& s) { return !s.value("homing", true); }));
  const json axes = shell.status()["axes"];
  EXPECT_TRUE(axes[0]["homed"].get<bool>());
  EXPECT_TRUE(axes[1]["homed"].get<bool>());
  EXPECT_FALSE(axes[2]["homed"].get<bool>());
  EXPECT_TRUE(contains(shell.run({"status"}).out, "not homed"));
}

TEST(Commands, keep_G91_from_block_to_block_in_MDI_and_start_again_after_a_reset) {
  Shell shell;
  shell.up();
  shell.ready();
  const double from = position(shell.status(), 0);
  EXPECT_EQ(shell.run({"mdi", "G91 G0 X10", "--wait"}).exit, 0);
  EXPECT_EQ(shell.run({"mdi", "X10", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), from + 20.0, 1e-6);
  EXPECT_EQ(shell.run({"jog", "X", "-5mm", "--wait"}).exit, 0);
  EXPECT_EQ(shell.run({"mdi", "X1", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), from + 16.0, 1e-6);
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_EQ(shell.run({"mdi", "G0 X1", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), 1.0, 1e-6);
}

TEST(Commands, start_the_spindle_by_a_typed_block_and_stop_it_by_a_reset) {
  Shell shell;
  shell.up();
  shell.ready();
  ASSERT_EQ(shell.run({"mdi", "S600 M3", "--wait"}).exit, 0);
  EXPECT_TRUE(shell.until([](const json& s) { return s["spindles"][0]["at_speed"].get<bool>(); }));
  EXPECT_NEAR(shell.status()["spindles"][0]["actual_rpm"].get<double>(), 600.0, 30.0);
  ASSERT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_TRUE(shell.until([](const json& s) { return s["spindles"][0]["actual_rpm"].get<double>() < 5.0; }));
}

TEST(Commands, refuse_a_wrong_block_before_anything_moves) {
  Shell shell;
  shell.up();
  shell.ready();
  const Outcome o = shell.run({"mdi", "G1 X10 Q5 F100"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "the block was not run: MDI:1:")) << o.err;
  EXPECT_EQ(shell.status()["state"], "idle");
  const Outcome far = shell.run({"mdi", "G0 X5000"});
  EXPECT_EQ(far.exit, 1);
  EXPECT_EQ(shell.status()["state"], "idle");
}

TEST(Commands, keep_a_zero_in_the_state_directory_and_use_it_in_MDI_and_programs) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string();
  const std::vector<std::string> more{"--virtual", "--speed", "20", "--state", state};
  std::ofstream(shell.folder() / "to10.nc") << "N10 G0 X10\nN20 M2\n";
  shell.up("mill", more);
  shell.ready();
  ASSERT_EQ(shell.run({"mdi", "G0 X20", "--wait"}).exit, 0);
  const Outcome zero = shell.run({"zero", "X", "-5"});
  EXPECT_EQ(zero.exit, 0);
  EXPECT_TRUE(contains(zero.out, "X is -5 mm here (origin 0 at 25)")) << zero.out;
  EXPECT_TRUE(contains(shell.text("state/origins.toml"), "25")) << "saved at once, not at the end";
  ASSERT_EQ(shell.run({"mdi", "G0 X0", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), 25.0, 1e-6);
  EXPECT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0);

  shell.up("mill", more);
  shell.ready();
  ASSERT_EQ(shell.run({"load", (shell.folder() / "to10.nc").string()}).exit, 0);
  ASSERT_EQ(shell.run({"start", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), 35.0, 1e-6);
}

TEST(Commands, save_the_references_when_homing_has_found_them) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "20", "--state", (shell.folder() / "state").string()});
  shell.ready();
  EXPECT_TRUE(
      shell.until([&](const json&) { return contains(shell.text("state/homing.toml"), "valid = true"); }));
}

TEST(Commands, load_start_step_hold_and_resume_a_program) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "5"});
  shell.ready();
  std::ofstream(shell.folder() / "long.nc") << "N10 G1 X100 F300\nN20 M0\nN30 X-100 F6000\nN40 M2\n";
  const std::string program = (shell.folder() / "long.nc").string();
  const Outcome loaded = shell.run({"load", program});
  EXPECT_EQ(loaded.exit, 0);
  EXPECT_TRUE(contains(loaded.out, "4 blocks"));
  ASSERT_EQ(shell.run({"start"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["feed_mm_min"] > 100.0; }));
  EXPECT_EQ(shell.status()["blocks"], 4);
  EXPECT_EQ(shell.run({"load", program}).exit, 1);
  ASSERT_EQ(shell.run({"hold"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["state"] == "held"; }));
  ASSERT_EQ(shell.run({"resume"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["state"] == "waiting"; })) << "M0";
  EXPECT_NEAR(position(shell.status(), 0), 100.0, 1e-6);
  ASSERT_EQ(shell.run({"override", "150"}).exit, 0);
  ASSERT_EQ(shell.run({"start", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 0), -100.0, 1e-6);
  ASSERT_EQ(shell.run({"step"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["state"] == "waiting"; })) << "end of the block";
  EXPECT_NEAR(position(shell.status(), 0), 100.0, 1e-6);
  ASSERT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_EQ(shell.status()["state"], "idle");
  ASSERT_EQ(shell.run({"start"}).exit, 0);
  EXPECT_TRUE(shell.until([](const json& s) { return s["state"] == "waiting"; })) << "a start after a reset";
  ASSERT_EQ(shell.run({"reset"}).exit, 0);
  std::ofstream(shell.folder() / "bad.nc") << "N10 G1 X1 Q7\n";
  const Outcome bad = shell.run({"load", (shell.folder() / "bad.nc").string()});
  EXPECT_EQ(bad.exit, 1);
  EXPECT_TRUE(contains(bad.err, "bad.nc:1:")) << bad.err;
}

TEST(Commands, play_the_world_of_a_mock_machine) {
  Shell shell;
  shell.up();
  shell.ready();
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "off"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return !s["alarms"].empty(); }));
  EXPECT_TRUE(contains(shell.run({"alarms"}).out, "emergency stop"));
  EXPECT_EQ(shell.run({"power", "on"}).exit, 1);
  EXPECT_TRUE(contains(shell.run({"reset"}).out, "still active"));
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "on"}).exit, 0);
  EXPECT_TRUE(
      shell.until([&](const json&) { return contains(shell.run({"reset"}).out, "no alarm is active"); }));
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"input", "x_limit_plus", "on"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["axes"][0]["on_limit"] == 1; }));
  EXPECT_TRUE(contains(shell.run({"jog", "X", "+1mm"}).err, "limit switch"));
  ASSERT_EQ(shell.run({"input", "x_limit_plus", "auto"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["axes"][0]["on_limit"] == 0; }));
}

TEST(Commands, show_positions_in_the_coordinates_of_the_program_and_of_the_machine) {
  Shell shell;
  shell.up();
  shell.ready();
  ASSERT_EQ(shell.run({"zero", "X", "5"}).exit, 0);
  const std::string out = shell.run({"status"}).out;
  EXPECT_TRUE(contains(out, "axes: in the program's coordinates, in machine coordinates, to go:\n  X ")) << out;
}

TEST(Control, listens_for_its_owner_only_and_leaves_nothing_behind) {
  Shell shell;
  shell.up();
  struct stat seen {};
  ASSERT_EQ(stat(shell.socket().c_str(), &seen), 0);
  EXPECT_EQ(seen.st_mode & 0777, 0600u);
  ASSERT_EQ(stat((shell.folder() / "servogate").c_str(), &seen), 0);
  EXPECT_EQ(seen.st_mode & 0777, 0700u);
  EXPECT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0);
  EXPECT_NE(stat(shell.socket().c_str(), &seen), 0);
}

TEST(Control, refuses_the_socket_of_another_one_and_takes_over_a_stale_one) {
  Shell shell;
  shell.up();
  const Outcome second = shell.run({"up", Shell::example("mill/machine.toml"), "--virtual"});
  EXPECT_EQ(second.exit, 4);
  EXPECT_TRUE(contains(second.err, "another control listens there")) << second.err;
  EXPECT_EQ(shell.end(SIGKILL), 128 + SIGKILL);
  EXPECT_TRUE(std::filesystem::exists(shell.socket())) << "it could not clean up";
  shell.up();
  EXPECT_EQ(shell.run({"status"}).exit, 0);
  const std::string file = (shell.folder() / "notes.txt").string();
  std::ofstream(file) << "mine";
  const Outcome over = shell.run({"up", Shell::example("mill/machine.toml"), "--virtual", "--socket", file});
  EXPECT_EQ(over.exit, 4);
  EXPECT_EQ(shell.text("notes.txt"), "mine");
}

TEST(Control, takes_SIGTERM_for_down_in_the_middle_of_a_motion) {
  Shell shell;
  shell.up("mill", {"--virtual", "--state", (shell.folder() / "state").string()});
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"jog", "X", "+50mm", "--no-wait"}).exit, 0);
  EXPECT_EQ(shell.end(SIGTERM), 0);
  EXPECT_TRUE(contains(shell.text("state/homing.toml"), "schema = 1"));
}

TEST(Control, works_in_real_time_with_best_effort) {
  Shell shell;
  shell.up("mill", {"--realtime=best-effort", "--state", (shell.folder() / "state").string()});
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  EXPECT_EQ(shell.run({"jog", "Y", "-1mm", "--wait"}).exit, 0);
  EXPECT_NEAR(position(shell.status(), 1), -1.0, 1e-9);
  EXPECT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0);
}

}  // namespace
}  // namespace servogate::gateway::testing
