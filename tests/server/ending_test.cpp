// SPDX-License-Identifier: Apache-2.0
// The end of a control as its clients see it: what they waited for, who ended it, and that nothing begins
// behind it.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/comes.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

TEST(Ending, begins_with_the_answer_to_down_and_refuses_whatever_comes_behind_it) {
  for (const char* request :
       {R"({"cmd":"mdi","block":"G0 X200"})", R"({"cmd":"jog","axis":"X","value":50})",
        R"({"cmd":"jog_continuous","axis":"X","value":1})", R"({"cmd":"home"})", R"({"cmd":"start"})",
        R"({"cmd":"power","value":1})", R"({"cmd":"mdi","block":"S500 M3"})"}) {
    Shell shell;
    shell.up("mill", {"--virtual", "--speed", "50"});
    shell.ready();
    SocketClient client;
    std::string answer;
    ASSERT_TRUE(client.connect(shell.socket()).empty());
    ASSERT_TRUE(client.exchange(R"({"cmd":"down"})", answer));
    ASSERT_TRUE(json::parse(answer)["ok"].get<bool>()) << answer;
    ASSERT_TRUE(client.exchange(request, answer));
    EXPECT_EQ(json::parse(answer)["code"], "socket.ending") << request << answer;
    if (client.exchange(R"({"cmd":"status"})", answer)) {
      EXPECT_EQ(json::parse(answer)["ending"], true);
      EXPECT_NEAR(json::parse(answer)["axes"][0]["command"].get<double>(), 0.0, 1e-3);
    }
    EXPECT_EQ(shell.wait(), 0);
  }
}

/// What a client says whose control is taken down when the status is `before`.
Outcome taken_down(const std::vector<std::string>& command, const std::string& before) {
  Shell shell;
  shell.up("mill", {"--virtual"});
  shell.ready();
  std::ofstream(shell.folder() / "p.nc") << "N10 G1 X200 F30\nN20 M30\n";
  EXPECT_EQ(shell.run({"load", (shell.folder() / "p.nc").string()}).exit, 0);
  const pid_t client = shell.spawn(command, "client");
  EXPECT_TRUE(shell.until([&](const json& s) {
    return s["state"] == before || (s["homing"] == true && before == "homing") ||
           (before == "moving" && (s["axes"][0]["moving"] == true || s["axes"][0]["jog_end"].is_object()));
  }));
  // By the socket: a process may begin later on a busy computer than a homing takes.
  EXPECT_TRUE(shell.ask({{"cmd", "down"}})["ok"].get<bool>());
  Outcome ended{ending_of(client), "", ""};
  ended.err = shell.text("client.err");
  EXPECT_EQ(shell.wait(), 0);
  return ended;
}

TEST(Ending, is_what_every_client_that_waits_ends_with_and_says) {
  struct Wait {
    std::vector<std::string> command;
    const char* before;  ///< of the status in which the control is taken down
  };
  for (const Wait& wait : {Wait{{"start", "--wait"}, "running"},
                           {{"mdi", "G1 X200 F30", "--wait"}, "running"},
                           {{"home", "--wait"}, "homing"},
                           {{"jog", "X", "+250mm"}, "moving"},
                           {{"jog", "X", "+"}, "moving"}}) {
    Outcome ended;
    // A hand that comes late on a busy computer is a dead one, as it must be: then once more.
    ASSERT_TRUE(tests::comes([&] {
      ended = taken_down(wait.command, wait.before);
      return !contains(ended.err, "[jog.keep-alive]");
    }));
    EXPECT_EQ(ended.exit, 3) << wait.command[0] << ' ' << ended.err;
    EXPECT_TRUE(contains(ended.err, "[client.control-ends]") || contains(ended.err, "[jog.asked]"))
        << wait.command[0] << ": " << ended.err;
  }
}

TEST(Ending, of_a_control_whose_drives_have_not_booted_is_no_failure) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "1"});
  ASSERT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0) << "nothing was ever switched on";
}

TEST(Ending, of_the_terminal_is_an_end_like_any_other_unless_the_caller_ignores_it) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "5"});
  shell.ready();
  ASSERT_EQ(shell.run({"mdi", "G1 X200 F6000"}).exit, 0);
  EXPECT_EQ(shell.end(SIGHUP), 0);
  const std::string report = (shell.folder() / "r.json").string();
  std::ofstream(shell.folder() / "long.nc") << "(RPT,99)\n(RPT,99)\nG1 X200 F9000\nX0\n(ERP)\n(ERP)\nM30\n";
  const pid_t run = shell.spawn(
      {"run", Shell::example("mill/machine.toml"), (shell.folder() / "long.nc").string(),
       "--realtime=best-effort", "--report", report, "--trace", (shell.folder() / "t.csv").string()},
      "run");
  ASSERT_TRUE(tests::comes([&] { return contains(shell.text("t.csv"), "\n8."); }));
  kill(run, SIGHUP);
  EXPECT_EQ(ending_of(run), 3) << shell.text("run.err");
  const json told = json::parse(shell.text("r.json"));
  EXPECT_FALSE(told["finished"].get<bool>());
  EXPECT_TRUE(told["alarms"].empty()) << told["alarms"].dump();
}

TEST(Homing, that_is_broken_off_is_no_success_even_of_axes_that_had_their_reference) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "2"});
  shell.ready();
  for (const double after_s : {1.5, 1.7, 1.8, 1.84, 1.9}) {
    int exit = 0;
    // Where a busy computer came too late, the homing was over, and there was nothing to break off.
    ASSERT_TRUE(tests::comes([&] {
      const double begun = shell.status()["time_s"];
      const pid_t client = shell.spawn({"home", "--wait"}, "home");
      EXPECT_TRUE(shell.until([&](const json& s) { return s["time_s"].get<double>() > begun + after_s; }));
      EXPECT_EQ(shell.ask({{"cmd", "hold"}})["ok"], true);
      exit = ending_of(client);
      return exit != 0;
    }));
    EXPECT_EQ(exit, 3) << after_s << ' ' << shell.text("home.err");
    EXPECT_FALSE(shell.status()["homing_left"].empty());
    ASSERT_EQ(shell.run({"reset"}).exit, 0);
  }
  EXPECT_EQ(shell.run({"home", "--wait"}).exit, 0);
  EXPECT_TRUE(shell.status()["homing_left"].empty());
}

}  // namespace
}  // namespace servogate::gateway::testing
