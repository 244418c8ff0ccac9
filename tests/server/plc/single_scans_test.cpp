// SPDX-License-Identifier: Apache-2.0
// Single scans of the PLC of a running control, and who may ask for them.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

TEST(SingleScans, show_the_values_of_each_and_let_the_plc_go) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const Outcome o = shell.run({"plc", "step", "MC.estop_ok", "Mill.change.step", "--scans", "3", "--json"});
  EXPECT_EQ(o.exit, 0) << o.err;
  std::istringstream lines(o.out);
  std::int64_t before = -1;
  int samples = 0;
  for (std::string line; std::getline(lines, line); ++samples) {
    const json sample = json::parse(line);
    EXPECT_GT(sample["cycle"].get<std::int64_t>(), before);
    before = sample["cycle"];
    EXPECT_EQ(sample["values"][0], (json{{"name", "MC.estop_ok"}, {"value", true}}))
        << "what the program wrote";
  }
  EXPECT_EQ(samples, 4) << "where it was held, and after each scan";
  EXPECT_TRUE(shell.status()["plc_held_by"].is_null());
  EXPECT_TRUE(has_alarm(shell.status(), 5004)) << "until the reset";
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_FALSE(has_alarm(shell.status(), 5004));
  shell.ready();
}

TEST(SingleScans, are_for_people_one_for_each_line_typed) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t client = shell.spawn({"plc", "step", "--source", "Mill.change"}, "step");
    EXPECT_TRUE(shell.until([](const json& s) { return s["plc_held_by"].is_string(); }));
    EXPECT_TRUE(
        shell.until([&](const json&) { return contains(shell.text("step.err"), "Enter runs a scan"); }));
    kill(client, signal);
    int status = 0;
    waitpid(client, &status, 0);
    EXPECT_EQ(status, 0);
    const std::string out = shell.text("step.out");
    EXPECT_TRUE(contains(out, "the PLC is held")) << out;
    EXPECT_TRUE(contains(out, "step = Idle")) << out;
    EXPECT_TRUE(contains(out, "the PLC runs freely again")) << out;
  }
}

TEST(SingleScans, are_refused_while_the_drives_are_on) {
  Shell shell;
  shell.up();
  shell.ready();
  const Outcome o = shell.run({"plc", "step", "MC.estop_ok", "--scans", "1"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "[gate.drives_on]")) << o.err;
  EXPECT_TRUE(shell.status()["axes"][0]["enabled"].get<bool>());
}

TEST(SingleScans, belong_to_the_client_that_holds_and_end_with_it) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  {
    SocketClient client;
    ASSERT_EQ(client.connect(shell.socket()), "");
    const auto ask = [&client](const std::string& line) {
      std::string answer;
      EXPECT_TRUE(client.exchange(line, answer));
      return json::parse(answer, nullptr, false);
    };
    json answer = ask(R"({"cmd":"plc_hold"})");
    ASSERT_TRUE(answer.value("ok", false)) << answer;
    EXPECT_FALSE(shell.status()["plc_held_by"].is_null());
    EXPECT_TRUE(contains(shell.run({"status"}).out, "the PLC is held for single scans"));
    for (const char* command : {"plc_step", "plc_go"}) {
      answer = shell.ask({{"cmd", command}});
      EXPECT_EQ(answer["code"], "plc.not-holder") << "another client";
    }
    EXPECT_EQ(shell.ask({{"cmd", "plc_hold"}})["code"], "gate.logic_held");
    for (const char* scans : {"100001", "0", "-1", "1.5", "1e300"}) {
      answer = ask(std::string(R"({"cmd":"plc_step","scans":)") + scans + "}");
      EXPECT_EQ(answer["code"], "gate.bad_value") << scans;
    }
    EXPECT_EQ(shell.run({"power", "on", "--no-wait"}).exit, 1);
  }
  EXPECT_TRUE(shell.until([](const json& s) { return s["plc_held_by"].is_null(); }));
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  shell.ready();
}

TEST(SingleScans, see_what_is_forced_between_them) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  ASSERT_EQ(shell.run({"plc", "force", "Mill.change.alarm=5", "--stay"}).exit, 0);
  const Outcome o = shell.run({"plc", "step", "Mill.change.alarm", "--scans", "1"});
  EXPECT_TRUE(contains(o.out, "Mill.change.alarm = 5  (forced)")) << o.out;
}

TEST(Forcing, takes_addresses_as_bit_strings_and_as_numbers) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  EXPECT_EQ(shell.run({"plc", "force", "%MW8=16#FF00", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("%MW8", 0xFF00));
  EXPECT_EQ(shell.plc_value("SK8.IN"), -256);
  EXPECT_TRUE(
      contains(shell.run({"plc", "watch", "SK8.IN", "--samples", "1"}).out, "SK8.IN = -256  (forced)"))
      << "by any name of the place";
  EXPECT_EQ(shell.run({"plc", "force", "%MW8=-2", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("%MW8", 0xFFFE));
  EXPECT_EQ(shell.status()["forced"].size(), 1u);
  EXPECT_EQ(shell.run({"plc", "force", "%MW8=high", "--stay"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "%MW99999=1", "--stay"}).exit, 1) << "outside the packet";
  EXPECT_EQ(shell.run({"plc", "force", "--release", "%MW8"}).exit, 0);
  EXPECT_TRUE(shell.status()["forced"].empty());
}

TEST(Forcing, holds_characters_that_no_variable_stands_for) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  EXPECT_EQ(shell.run({"plc", "force", "SK800.4CH=abc", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("SK200.LI", 0x20636261)) << "'abc ' from the lowest byte on";
  EXPECT_TRUE(contains(shell.run({"status"}).out, "forced: SK800.4CH = abc"));
  EXPECT_EQ(shell.run({"plc", "force", "SK800.4CH=longer", "--stay"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "SK800.4CH=xy", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("SK200.LI", 0x20207978));
  EXPECT_EQ(shell.run({"plc", "force", "--release"}).exit, 0);
  EXPECT_TRUE(shell.status()["forced"].empty());
}

TEST(Forcing, is_marked_at_what_it_reaches_under_another_name) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  EXPECT_EQ(shell.run({"plc", "force", "LAMP_green=TRUE", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("lamp_green", true));
  const Outcome watched = shell.run({"plc", "watch", "lamp_green", "--samples", "1"});
  EXPECT_TRUE(contains(watched.out, "lamp_green = TRUE  (forced)")) << watched.out;
  EXPECT_TRUE(contains(shell.run({"plc", "list"}).out, "forced to TRUE"));
}

}  // namespace
}  // namespace servogate::gateway::testing
