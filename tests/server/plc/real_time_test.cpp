// SPDX-License-Identifier: Apache-2.0
// The PLC against the clock of the wall: a scan over its watchdog, and single scans between which none runs.
// A scan that ends, and how long it took: tests/cycle/executive_test.cpp, in virtual time. Here it is one
// that cannot end, so that the clock decides nothing but when it is ended.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// Runs beside the logic of the mill. Its loop ends by nothing else within the watchdog's two seconds,
/// however fast the computer: each of the thousand million instructions that it may take turns a number into
/// text.
constexpr const char* kBeside = R"(
PROGRAM Beside
VAR begin : BOOL; scans : DINT; words : STRING; number : LREAL := 0.1; END_VAR
scans := scans + 1;
WHILE begin DO
  words := CONCAT(LREAL_TO_STRING(number), LREAL_TO_STRING(number));
END_WHILE;
END_PROGRAM
)";

/// The example mill with that program and a watchdog, in real time.
void up(Shell& shell) {
  std::ifstream example(Shell::example("mill/machine.toml"));
  std::string machine((std::istreambuf_iterator<char>(example)), {});
  const std::string sources = "sources = [\"mill.st\"]";
  ASSERT_NE(machine.find(sources), std::string::npos);
  machine.replace(machine.find(sources), sources.size(),
                  "sources = [\"mill.st\", \"beside.st\"]\nwatchdog = \"2 s\"\n"
                  "instruction_budget = 1000000000");
  std::ofstream(shell.folder() / "machine.toml") << machine;
  std::ofstream(shell.folder() / "beside.st") << kBeside;
  std::filesystem::copy_file(Shell::example("mill/mill.st"), shell.folder() / "mill.st");
  shell.up_file((shell.folder() / "machine.toml").string(),
                {"--realtime=best-effort", "--state", (shell.folder() / "state").string()});
}

bool any_axis_on(const json& status) {
  for (const json& a : status["axes"])
    if (a["enabled"].get<bool>()) return true;
  return false;
}

TEST(RealTimeLogic, over_its_watchdog_stops_the_machine_with_the_alarm_that_says_so) {
  Shell shell;
  up(shell);
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  EXPECT_TRUE(any_axis_on(shell.status()));
  shell.run({"plc", "force", "Beside.begin=TRUE", "--stay"});  // its answer may come too late
  ASSERT_TRUE(shell.until([](const json& s) { return has_alarm(s, 5005); })) << shell.status();
  EXPECT_TRUE(shell.until([](const json& s) { return !any_axis_on(s); }));
  const json alarm = alarm_of(shell.status(), 5005);
  EXPECT_TRUE(contains(alarm["text"], "a scan of the PLC took")) << alarm;
  EXPECT_TRUE(contains(alarm["text"], "allowed 2000 ms")) << alarm;
  EXPECT_TRUE(contains(shell.run({"alarms"}).out, "5005"));
  EXPECT_TRUE(has_alarm(shell.status(), 5002)) << "and it was ended";
  ASSERT_EQ(shell.run({"plc", "force", "--release"}).exit, 0);
  const Outcome loaded = shell.run({"plc", "load"});
  EXPECT_EQ(loaded.exit, 0) << "the program begins anew: " << loaded.err;
  EXPECT_TRUE(shell.plc_becomes("MC.estop_ok", true));
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_FALSE(has_alarm(shell.status(), 5005));
  // Once the drives are off; what a busy computer does to the drives meanwhile is reset, too.
  EXPECT_TRUE(shell.until([&](const json&) {
    shell.run({"reset"});
    return shell.run({"power", "on", "--wait"}).exit == 0;
  })) << shell.status();
}

TEST(RealTimeLogic, held_by_single_scans_does_not_scan_between_them_and_the_axes_are_off) {
  Shell shell;
  up(shell);
  ASSERT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
  EXPECT_EQ(shell.run({"plc", "step", "Beside.scans", "--scans", "1"}).exit, 1) << "not with the drives on";
  ASSERT_EQ(shell.run({"power", "off", "--wait"}).exit, 0);
  const Outcome o = shell.run({"plc", "step", "Beside.scans", "--scans", "4", "--json"});
  EXPECT_EQ(o.exit, 0) << o.err;
  std::vector<std::int64_t> scans, cycles;
  std::istringstream lines(o.out);
  for (std::string line; std::getline(lines, line);) {
    const json sample = json::parse(line);
    scans.push_back(sample["values"][0]["value"]);
    cycles.push_back(sample["cycle"]);
  }
  ASSERT_EQ(scans.size(), 5u) << o.out;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    EXPECT_EQ(scans[i], scans[i - 1] + 1) << "one scan each time";
    EXPECT_GT(cycles[i], cycles[i - 1]) << "while the cycle goes on";
  }
  EXPECT_FALSE(any_axis_on(shell.status()));
  EXPECT_EQ(shell.run({"power", "on", "--no-wait"}).exit, 1) << "until the reset";
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_EQ(shell.run({"power", "on", "--wait"}).exit, 0);
}

}  // namespace
}  // namespace servogate::gateway::testing
