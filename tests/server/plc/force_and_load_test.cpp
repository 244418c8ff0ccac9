// SPDX-License-Identifier: Apache-2.0
// The PLC of a running control, as its programmer sees and changes it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// mill.st in the test's folder, with a counter in it.
std::string mill_with(const Shell& shell, const std::string& declaration, const std::string& statement) {
  std::ifstream in(Shell::example("mill/mill.st"));
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string program = "PROGRAM Mill\n", end = "END_PROGRAM";
  text.replace(text.find(program), program.size(), program + declaration + "\n");
  text.replace(text.find(end), end.size(), statement + "\n" + end);
  const std::string path = (shell.folder() / "mill.st").string();
  std::ofstream(path) << text;
  return path;
}

TEST(PlcOfAControl, is_listed_with_type_place_and_where_it_is_read_and_written) {
  Shell shell;
  shell.up();
  const Outcome o = shell.run({"plc", "list"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_TRUE(contains(o.out, "door_closed                  BOOL           SA16")) << o.out.substr(0, 2000);
  EXPECT_TRUE(contains(o.out, "tool_release")) << o.out.substr(0, 500);
  const json list = json::parse(shell.run({"plc", "list", "--json"}).out);
  bool found = false;
  for (const json& s : list["symbols"])
    if (s["name"] == "Mill.spindle_on") {
      found = true;
      EXPECT_EQ(s["type"], "BOOL");
      EXPECT_GE(s["written"].size(), 4u);
      EXPECT_GE(s["read"].size(), 1u);
    }
  EXPECT_TRUE(found);
  const json files = json::parse(shell
                                     .run({"plc", "list", Shell::example("mill/mill.st"), "--machine",
                                           Shell::example("mill/machine.toml"), "--json"})
                                     .out);
  EXPECT_EQ(files["symbols"], list["symbols"]) << "the same without a control";
}

TEST(PlcOfAControl, is_watched_by_name_and_beside_its_source_lines) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const Outcome names = shell.run(
      {"plc", "watch", "door_closed", "Mill.change.step", "SK10.IN", "--samples", "2", "--every", "20"});
  EXPECT_EQ(names.exit, 0) << names.err;
  EXPECT_TRUE(contains(names.out, "  Mill.change.step = Idle\n")) << names.out;
  EXPECT_TRUE(contains(names.out, "  SK10.IN = 0\n")) << names.out;
  const Outcome places = shell.run({"plc", "watch", "%MW120", "SK120.4CH", "%IX100.3", "--samples", "1"});
  EXPECT_EQ(places.exit, 0) << places.err;
  EXPECT_TRUE(contains(places.out, "  %MW120 = 0\n")) << places.out;
  EXPECT_TRUE(contains(places.out, "  SK120.4CH = ")) << places.out;
  EXPECT_TRUE(contains(places.out, "  %IX100.3 = FALSE\n")) << places.out;
  EXPECT_EQ(shell.run({"plc", "watch", "%MW99999", "--samples", "1"}).exit, 2) << "outside packet K";
  const Outcome objects =
      shell.run({"plc", "watch", "MC.estop_ok", "--json", "--samples", "3", "--every", "1"});
  std::istringstream lines(objects.out);
  std::int64_t before = -1;
  int samples = 0;
  for (std::string line; std::getline(lines, line); ++samples) {
    const json sample = json::parse(line);
    EXPECT_GT(sample["cycle"].get<std::int64_t>(), before) << "one object a sample";
    before = sample["cycle"];
    EXPECT_EQ(sample["values"][0], (json{{"name", "MC.estop_ok"}, {"value", true}}));
  }
  EXPECT_EQ(samples, 3);
  const Outcome source = shell.run({"plc", "watch", "--samples", "1"});
  EXPECT_TRUE(contains(source.out, "MC.estop_ok := MC.estop_chain;")) << source.out;
  EXPECT_TRUE(contains(source.out, "| MC.estop_chain = TRUE, MC.estop_ok = TRUE") ||
              contains(source.out, "| MC.estop_ok = TRUE, MC.estop_chain = TRUE"))
      << source.out;
  const Outcome block = shell.run({"plc", "watch", "--source", "Mill.change", "--samples", "1"});
  EXPECT_TRUE(contains(block.out, "step = Idle")) << block.out;
  EXPECT_EQ(shell.run({"plc", "watch", "no_such", "--samples", "1"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "watch", "--source", "Nothing", "--samples", "1"}).exit, 2);
  const Outcome times = shell.run({"plc", "watch", "--times", "--samples", "1"});
  EXPECT_TRUE(contains(times.out, "ToolChange")) << times.out;
}

TEST(PlcOfAControl, shows_what_VAR_CONFIG_put_at_an_address_and_no_address_of_a_parameter) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const std::string path = mill_with(shell, "VAR counter : Counted; total : INT; own AT %M* : INT; END_VAR",
                                     "counter(sum := total);");
  std::ofstream(path, std::ios::app) << R"(
FUNCTION_BLOCK Counted
VAR_IN_OUT sum : INT; END_VAR
VAR seen AT %M* : INT; END_VAR
sum := 5;
seen := 7;
END_FUNCTION_BLOCK
CONFIGURATION c
PROGRAM Mill : Mill;
VAR_CONFIG Mill.counter.seen AT %MW40 : INT; Mill.own AT %MW41 : INT; END_VAR
END_CONFIGURATION
)";
  const Outcome loaded = shell.run({"plc", "load", path});
  ASSERT_EQ(loaded.exit, 0) << loaded.err;
  EXPECT_TRUE(shell.plc_becomes("Mill.counter.seen", 7));
  EXPECT_EQ(shell.plc_value("SK40.IN"), 7);
  EXPECT_EQ(shell.plc_value("Mill.total"), 5);
  const Outcome source = shell.run({"plc", "watch", "--source", "Mill.counter", "--samples", "1"});
  EXPECT_TRUE(contains(source.out, "| seen = 7")) << source.out;
  EXPECT_FALSE(contains(source.out, "sum = ")) << "it is another variable in each call: " << source.out;
  const json list = json::parse(shell.run({"plc", "list", "--json"}).out);
  int rows = 0;
  for (const json& s : list["symbols"])
    if (s["name"] == "Mill.own") {
      ++rows;
      EXPECT_EQ(s["place"], "SK41.IN");
    }
  EXPECT_EQ(rows, 1);
}

TEST(PlcOfAControl, is_forced_until_the_client_ends_however_it_ends) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const pid_t client = shell.spawn({"plc", "force", "lamp_green=TRUE", "Mill.coolant_on=TRUE"}, "force");
  ASSERT_TRUE(shell.plc_becomes("lamp_green", true)) << "an output that the PLC writes FALSE in every scan";
  ASSERT_TRUE(shell.plc_becomes("Mill.coolant_on", true));
  EXPECT_EQ(shell.status()["forced"].size(), 2u);
  EXPECT_TRUE(contains(shell.run({"status"}).out, "forced: lamp_green = TRUE"));
  EXPECT_TRUE(contains(shell.run({"plc", "list"}).out, "forced to TRUE"));
  EXPECT_TRUE(contains(shell.run({"plc", "watch", "lamp_green", "--samples", "1"}).out,
                       "lamp_green = TRUE  (forced)"));
  kill(client, SIGKILL);
  waitpid(client, nullptr, 0);
  EXPECT_TRUE(shell.plc_becomes("lamp_green", false));
  EXPECT_TRUE(shell.plc_becomes("Mill.coolant_on", false));
  EXPECT_TRUE(shell.status()["forced"].empty());
}

TEST(PlcOfAControl, stays_forced_when_told_and_is_let_go_by_name) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  EXPECT_EQ(shell.run({"plc", "force", "lamp_green=TRUE", "Mill.change.alarm=-3", "--stay"}).exit, 0);
  EXPECT_EQ(shell.plc_value("lamp_green"), true);
  EXPECT_EQ(shell.plc_value("Mill.change.alarm"), -3);
  EXPECT_TRUE(contains(shell.run({"status"}).out, "stays")) << shell.run({"status"}).out;
  EXPECT_TRUE(contains(shell.run({"plc", "force"}).out, "Mill.change.alarm = -3"));
  EXPECT_EQ(shell.run({"plc", "force", "--release", "lamp_green"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("lamp_green", false));
  EXPECT_EQ(shell.run({"plc", "force", "--release", "lamp_green"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "--release"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("Mill.change.alarm", 0));
  EXPECT_EQ(shell.run({"plc", "force", "no_such=1", "--stay"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "Mill.change.alarm=high", "--stay"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "lamp_green", "--stay"}).exit, 2);
}

TEST(PlcOfAControl, holds_a_string_in_a_packet_that_its_program_writes) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const std::string file = mill_with(shell, "VAR word AT SK800.4CH : STRING[4]; END_VAR", "word := 'free';");
  ASSERT_EQ(shell.run({"plc", "load", file}).exit, 0);
  ASSERT_TRUE(shell.plc_becomes("Mill.word", "free"));
  EXPECT_EQ(shell.run({"plc", "force", "Mill.word=held", "--stay"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("Mill.word", "held"));
  EXPECT_TRUE(shell.plc_becomes("SK200.LI", 0x646c6568))
      << "in the packet too: 'held' from the lowest byte on";
  EXPECT_TRUE(contains(shell.run({"status"}).out, "forced: Mill.word = held"));
  EXPECT_EQ(shell.run({"plc", "force", "Mill.word=longer", "--stay"}).exit, 2);
  EXPECT_EQ(shell.run({"plc", "force", "--release"}).exit, 0);
  EXPECT_TRUE(shell.plc_becomes("Mill.word", "free"));
}

TEST(PlcOfAControl, cannot_be_made_to_hide_the_emergency_stop) {
  Shell shell;
  shell.up();
  for (const char* setting : {"estop_chain_ok=TRUE", "MC.estop_ok=TRUE"}) {
    const Outcome o = shell.run({"plc", "force", setting, "--stay"});
    EXPECT_EQ(o.exit, 1) << setting;
    EXPECT_TRUE(contains(o.err, "[gate.emergency_stop_place]")) << o.err;
  }
}

TEST(PlcOfAControl, cannot_be_made_to_hide_it_behind_another_name_of_its_place) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  const std::string path =
      mill_with(shell, "VAR chain AT %I* : BOOL; seen : BOOL; END_VAR", "seen := chain;");
  std::ofstream(path, std::ios::app) << R"(
CONFIGURATION c
PROGRAM Mill : Mill;
VAR_CONFIG Mill.chain AT estop_chain_ok : BOOL; END_VAR
VAR_ACCESS other : Mill.chain : BOOL READ_ONLY; END_VAR
END_CONFIGURATION
)";
  ASSERT_EQ(shell.run({"plc", "load", path}).exit, 0);
  ASSERT_TRUE(shell.plc_becomes("Mill.seen", true));
  for (const char* name : {"Mill.chain=TRUE", "other=TRUE"}) {
    const Outcome o = shell.run({"plc", "force", name, "--stay"});
    EXPECT_EQ(o.exit, 1) << name;
    EXPECT_TRUE(contains(o.err, "the emergency stop cannot be forced")) << o.err;
  }
}

TEST(PlcOfAControl, takes_another_program_between_two_scans_with_its_values) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string();
  shell.up("mill", {"--virtual", "--speed", "5", "--state", state});
  const std::string first = mill_with(shell, "VAR RETAIN kept : DINT; END_VAR VAR passing : DINT; END_VAR",
                                      "kept := kept + 1; passing := passing + 1;");
  const Outcome loaded = shell.run({"plc", "load", first});
  EXPECT_EQ(loaded.exit, 0) << loaded.err;
  ASSERT_TRUE(shell.until([&](const json&) { return shell.plc_value("Mill.kept") > 50; }));
  EXPECT_TRUE(contains(shell.run({"plc", "list"}).out, "Mill.kept"));

  mill_with(shell, "VAR RETAIN kept : DINT; END_VAR VAR passing : DINT; END_VAR", "passing := passing;");
  EXPECT_EQ(shell.run({"plc", "load", first, "--online"}).exit, 0);
  const json kept = shell.plc_value("Mill.kept"), passing = shell.plc_value("Mill.passing");
  EXPECT_GT(kept, 50);
  EXPECT_GT(passing, 50) << "an online change keeps every variable";
  EXPECT_EQ(shell.run({"plc", "load", first}).exit, 0);
  EXPECT_EQ(shell.plc_value("Mill.kept"), kept) << "retained";
  EXPECT_EQ(shell.plc_value("Mill.passing"), 0) << "not retained";

  std::istringstream log(shell.text("state/plc-changes.jsonl"));
  int entries = 0;
  for (std::string line; std::getline(log, line); ++entries) {
    const json entry = json::parse(line);
    EXPECT_EQ(entry["files"][0]["path"], first);
    EXPECT_EQ(entry["files"][0]["sha256"].get<std::string>().size(), 64u);
    EXPECT_FALSE(entry["user"].get<std::string>().empty());
    EXPECT_EQ(entry["when"].get<std::string>().size(), 20u);
  }
  EXPECT_EQ(entries, 3);
}

TEST(PlcOfAControl, keeps_its_program_when_the_new_one_has_errors) {
  Shell shell;
  shell.up();
  const std::string wrong = mill_with(shell, "VAR x : INT; END_VAR", "x := TRUE;");
  const Outcome o = shell.run({"plc", "load", wrong});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "mill.st:") && contains(o.err, "expected INT, found BOOL") &&
              contains(o.err, "^"))
      << o.err;
  EXPECT_EQ(shell.run({"plc", "load", (shell.folder() / "none.st").string()}).exit, 2);
  EXPECT_TRUE(shell.plc_becomes("MC.estop_ok", true));
}

TEST(PlcOfAControl, is_not_changed_while_something_moves_unless_that_is_declared_safe) {
  Shell shell;
  shell.up("mill", {"--virtual", "--speed", "5"});
  shell.ready();
  std::ofstream(shell.folder() / "long.nc") << "N10 G1 X100 F2\nN20 M2\n";  // ten minutes
  ASSERT_EQ(shell.run({"load", (shell.folder() / "long.nc").string()}).exit, 0);
  ASSERT_EQ(shell.run({"start"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["feed_mm_min"] > 1.0; }));
  const std::string other = mill_with(shell, "VAR extra : INT; END_VAR", "extra := 7;");
  for (const auto& arguments : {std::vector<std::string>{"plc", "load", other},
                                std::vector<std::string>{"plc", "load", other, "--online"}}) {
    const Outcome o = shell.run(arguments);
    EXPECT_EQ(o.exit, 1);
    EXPECT_TRUE(contains(o.err, "[gate.program_runs]")) << o.err;
  }
  EXPECT_EQ(shell.run({"plc", "load", other, "--while-running"}).exit, 2) << "only as an online change";
  const Outcome o = shell.run({"plc", "load", other, "--online", "--while-running"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_TRUE(shell.plc_becomes("Mill.extra", 7));
  const json s = shell.status();
  EXPECT_EQ(s["state"], "running");
  EXPECT_TRUE(s["axes"][0]["enabled"].get<bool>()) << "no enable has dropped";
  EXPECT_TRUE(s["alarms"].empty());
}

TEST(PlcOfAControl, keeps_its_forces_over_a_change_of_program) {
  Shell shell;
  shell.up();
  ASSERT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  ASSERT_EQ(shell.run({"plc", "force", "Mill.change.alarm=5", "--stay"}).exit, 0);
  ASSERT_EQ(shell.run({"plc", "load"}).exit, 0);
  EXPECT_EQ(shell.plc_value("Mill.change.alarm"), 5);
  EXPECT_EQ(shell.status()["forced"].size(), 1u);
}

}  // namespace
}  // namespace servogate::gateway::testing
