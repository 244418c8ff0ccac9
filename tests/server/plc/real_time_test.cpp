// SPDX-License-Identifier: Apache-2.0
// The PLC against the clock of the wall: a scan over its watchdog, and single scans between which none runs.
// A scan of this program takes some microseconds, the watchdog 40 ms, the long scan about 150 ms on a
// computer of 2020, and half a second ends a scan: a computer has to be far busier, or faster, to make one of
// them another.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// Runs beside the logic of the mill. The loop stays below the instruction budget: turning numbers into text
/// is one instruction each and takes its time.
constexpr const char* kBeside = R"(
PROGRAM Beside
VAR begin, begun : BOOL; turn, scans : DINT; words : STRING; number : LREAL := 0.1; END_VAR
scans := scans + 1;
IF begin AND NOT begun THEN
  begun := TRUE;
  FOR turn := 1 TO 400_000 DO
    words := CONCAT(LREAL_TO_STRING(number), LREAL_TO_STRING(number + 0.3));
    number := number * 1.0000001;
  END_FOR;
END_IF;
END_PROGRAM
)";

/// The example mill with that program and a watchdog, in real time.
void up(Shell& shell) {
  std::ifstream example(Shell::example("mill/machine.toml"));
  std::string machine((std::istreambuf_iterator<char>(example)), {});
  const std::string sources = "sources = [\"mill.st\"]";
  ASSERT_NE(machine.find(sources), std::string::npos);
  machine.replace(machine.find(sources), sources.size(),
                  "sources = [\"mill.st\", \"beside.st\"]\nwatchdog = \"40 ms\"\n"
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
  json status = shell.status();
  EXPECT_TRUE(any_axis_on(status));
  EXPECT_FALSE(has_alarm(status, 5005)) << status["alarms"];
  shell.run({"plc", "force", "Beside.begin=TRUE", "--stay"});  // its answer may come too late
  ASSERT_TRUE(shell.until([](const json& s) { return has_alarm(s, 5005); }, 120.0)) << shell.status();
  EXPECT_TRUE(shell.until([](const json& s) { return !any_axis_on(s); }));
  const json alarm = alarm_of(shell.status(), 5005);
  EXPECT_TRUE(contains(alarm["text"], "a scan of the PLC took")) << alarm;
  EXPECT_TRUE(contains(alarm["text"], "allowed 40 ms")) << alarm;
  EXPECT_TRUE(contains(shell.run({"alarms"}).out, "5005"));
  EXPECT_EQ(shell.plc_value("Beside.begun"), true) << "the program goes on";
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_FALSE(has_alarm(shell.status(), 5005));
  EXPECT_TRUE(shell.until([&](const json&) {
    return shell.run({"power", "on", "--wait"}).exit == 0;
  })) << "once the drives are off";
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
