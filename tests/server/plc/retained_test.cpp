// SPDX-License-Identifier: Apache-2.0
// Retained variables of the PLC over ends of the control that nobody announced.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "machine/state/state.hpp"
#include "tests/comes.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The mill with a second source: a counter in three places that always belong together.
constexpr const char* kCounter = R"(PROGRAM Counter
VAR RETAIN count : DINT; again : ARRAY[1..40] OF DINT; shown : STRING; END_VAR
VAR i : INT; END_VAR
count := count + 1;
FOR i := 1 TO 40 DO again[i] := count; END_FOR;
shown := DINT_TO_STRING(count);
END_PROGRAM
)";

std::string counting_mill(const Shell& shell) {
  std::ifstream in(Shell::example("mill/machine.toml"));
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string sources = "\"mill.st\"";
  const std::size_t at = text.find(sources);
  EXPECT_NE(at, std::string::npos);
  text.replace(at, sources.size(), sources + ", \"counter.st\"");
  std::ofstream(shell.folder() / "machine.toml") << text;
  std::ofstream(shell.folder() / "counter.st") << kCounter;
  fs::copy_file(Shell::example("mill/mill.st"), shell.folder() / "mill.st");
  return (shell.folder() / "machine.toml").string();
}

/// What the next start would find; -1: nothing yet.
std::int64_t kept_count(const std::string& state) {
  const machine::StateDirectory::Loaded kept = machine::StateDirectory(state).load();
  EXPECT_TRUE(kept.ok());
  std::int64_t count = -1;
  for (const machine::RetainedVariable& v : kept.state.retained)
    if (v.name == "Counter.count") count = std::stoll(v.value);
  const std::string number = std::to_string(count);
  for (const machine::RetainedVariable& v : kept.state.retained) {
    const bool text = v.name == "Counter.shown";
    if (text || v.name.starts_with("Counter.again")) {
      EXPECT_EQ(v.value, text ? "'" + number + "'" : number) << v.name;
    }
  }
  return count;
}

bool grows_beyond(const std::string& state, std::int64_t count) {
  return tests::comes([&] { return kept_count(state) > count; }, std::chrono::milliseconds(20));
}

TEST(RetainedVariables, survive_kill_9_at_any_time_and_are_never_a_mixture_of_two_scans) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  std::int64_t before = -1;
  for (int life = 0; life < 8; ++life) {
    shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
    ASSERT_TRUE(grows_beyond(state, before)) << "life " << life;
    std::this_thread::sleep_for(std::chrono::milliseconds(7 * life));  // any time will do
    EXPECT_EQ(shell.end(SIGKILL), 128 + SIGKILL);
    const std::int64_t now = kept_count(state);
    EXPECT_GT(now, before) << "life " << life << ": it went on from what was kept";
    before = now;
  }
}

TEST(RetainedVariables, are_those_of_the_last_scan_after_an_orderly_end) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  ASSERT_TRUE(grows_beyond(state, 100));
  ASSERT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0);
  const std::int64_t first = kept_count(state);
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  ASSERT_TRUE(grows_beyond(state, first));
}

TEST(RetainedVariables, that_are_lost_keep_the_control_from_starting_until_somebody_agrees) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  for (int copies = 0; copies < 2; ++copies) ASSERT_TRUE(grows_beyond(state, kept_count(state)));
  shell.end(SIGKILL);
  for (const char* copy : {"/retained.a.toml", "/retained.b.toml"}) fs::resize_file(state + copy, 100);
  const Outcome refused = shell.run({"up", machine, "--virtual", "--state", state});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.err.find("[state.retained_lost]"), std::string::npos) << refused.err;
  for (const char* copy : {"/retained.a.toml", "/retained.b.toml"}) fs::remove(state + copy);
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  EXPECT_TRUE(grows_beyond(state, 0));
}

TEST(RetainedVariables, without_a_variable_of_their_name_and_type_are_named) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  ASSERT_TRUE(grows_beyond(state, 10));
  shell.end(SIGKILL);
  std::ofstream(shell.folder() / "counter.st")
      << "PROGRAM Counter VAR RETAIN count : LINT; END_VAR count := count + 1; END_PROGRAM\n";
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  EXPECT_NE(
      shell.text("up.err").find("'Counter.count' is kept aside: the PLC has no such variable of type DINT"),
      std::string::npos)
      << shell.text("up.err");
}

/// The value of a variable as `plc watch` shows it.
std::int64_t watched(Shell& shell, const std::string& name) {
  const json sample =
      json::parse(shell.run({"plc", "watch", name, "--samples", "1", "--json"}).out, nullptr, false);
  return sample.is_object() ? sample["values"][0]["value"].get<std::int64_t>() : -1;
}

TEST(RetainedVariables, that_a_loaded_program_does_not_have_are_named_and_come_back_with_one_that_has_them) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  ASSERT_TRUE(grows_beyond(state, 1000));
  const std::string other = (shell.folder() / "mill.st").string();
  const Outcome without = shell.run({"plc", "load", other});
  EXPECT_EQ(without.exit, 0);
  EXPECT_NE(without.out.find("kept aside until a program has them: Counter.count, Counter.again[1]"),
            std::string::npos)
      << without.out;
  EXPECT_GT(kept_count(state), 1000) << "they stay on the disk";
  const Outcome with = shell.run({"plc", "load", other, (shell.folder() / "counter.st").string(), "--json"});
  const json told = json::parse(with.out, nullptr, false);
  EXPECT_EQ(told["taken_back"].size(), 42u) << with.out;
  EXPECT_TRUE(told["set_aside"].empty());
  EXPECT_GT(watched(shell, "Counter.count"), 1000);
}

TEST(RetainedVariables, that_a_loaded_program_does_not_have_are_there_after_a_kill_and_a_new_start) {
  Shell shell;
  const std::string machine = counting_mill(shell), state = (shell.folder() / "state").string();
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  ASSERT_TRUE(grows_beyond(state, 1000));
  ASSERT_EQ(shell.run({"plc", "load", (shell.folder() / "mill.st").string()}).exit, 0);
  shell.end(SIGKILL);
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", state});
  EXPECT_GT(watched(shell, "Counter.count"), 1000);
}

TEST(RetainedVariables, whose_type_has_other_limits_in_a_loaded_program_are_said_to_begin_anew) {
  Shell shell;
  const std::string machine = counting_mill(shell), mill = (shell.folder() / "mill.st").string();
  const std::string level = (shell.folder() / "level.st").string();
  const auto write_level = [&](const std::string& limits) {
    std::ofstream(level) << "TYPE Percent : INT (" << limits << "); END_TYPE\n"
                         << "PROGRAM Level VAR RETAIN p : Percent; END_VAR p := 7; END_PROGRAM\n";
  };
  write_level("0..50");
  shell.up_file(machine, {"--virtual", "--speed", "5", "--state", (shell.folder() / "state").string()});
  ASSERT_EQ(shell.run({"plc", "load", mill, level}).exit, 0);
  write_level("0..100");
  const Outcome other = shell.run({"plc", "load", mill, level});
  EXPECT_NE(other.out.find("warning: retained variables begin anew, for their types have changed: Level.p"),
            std::string::npos)
      << other.out;
}

/// A tool that nobody remembers is changed into one that sits there already.
TEST(ToolInTheSpindle, is_written_when_it_is_changed_and_known_after_a_power_cut) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string();
  const std::vector<std::string> how{"--virtual", "--speed", "20", "--state", state};
  shell.up("mill", how);
  shell.ready();
  ASSERT_EQ(shell.run({"mdi", "T2.2 M6", "--wait"}).exit, 0);
  EXPECT_TRUE(shell.until(
      [&](const json&) { return contains(shell.text("state/tools.toml"), "tool_in_spindle = 2"); }));
  EXPECT_EQ(shell.end(SIGKILL), 128 + SIGKILL);
  shell.up("mill", how);
  EXPECT_EQ(shell.status()["processes"][0]["tool"], 2);
  ASSERT_EQ(shell.run({"down"}).exit, 0);
  EXPECT_EQ(shell.wait(), 0);
  EXPECT_TRUE(contains(shell.text("state/tools.toml"), "tool_in_spindle = 2"));
}

}  // namespace
}  // namespace servogate::gateway::testing
