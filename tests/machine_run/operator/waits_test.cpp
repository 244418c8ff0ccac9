// SPDX-License-Identifier: Apache-2.0
// `servogate run` of programs that wait for what nobody does: it names the wait and ends.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/comes.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using nlohmann::json;

/// A run that is given up, with what it left behind.
struct GivenUp {
  Ending ending;
  json report;
};

GivenUp give_up(const Scratch& scratch, const std::string& machine, const std::string& program,
                const std::vector<std::string>& more = {}, const Environment& environment = {}) {
  std::vector<std::string> arguments{"run",
                                     machine,
                                     scratch.write("waits.nc", program),
                                     "--report",
                                     scratch.path("r.json"),
                                     "--trace",
                                     scratch.path("t.csv")};
  arguments.insert(arguments.end(), more.begin(), more.end());
  GivenUp run;
  run.ending = servogate(arguments, environment);
  run.report = json::parse(read_all(scratch.path("r.json")), nullptr, false);
  return run;
}

bool says(const Ending& e, const std::string& words) { return e.err.find(words) != std::string::npos; }

TEST(Waits, for_a_signal_that_never_comes_are_named_and_end_the_run) {
  const Scratch scratch;
  const GivenUp run = give_up(scratch, mill_file(), "N10 G0 X3\nN20 (WAI,SA20=1)\nN30 M30\n");
  EXPECT_EQ(run.ending.code, 1);
  EXPECT_TRUE(
      says(run.ending, "line 2 of waits.nc: the program waits until cycle_start (SA20.BL) = 1; it is 0"))
      << run.ending.err;
  EXPECT_TRUE(says(run.ending, "[run.gave-up]")) << run.ending.err;
  EXPECT_TRUE(says(run.ending, "cycle_start (SA20.BL) is an input of the simulated station 'panel'"))
      << run.ending.err;
  EXPECT_TRUE(says(run.ending, "(5")) << "and while it waited, after five seconds: " << run.ending.err;
  EXPECT_FALSE(run.report["finished"].get<bool>());
  EXPECT_EQ(run.report["wait"]["reason"], "signal");
  EXPECT_EQ(run.report["wait"]["line"], 2);
  EXPECT_EQ(run.report["wait"]["for_s"], 60.0);
  EXPECT_TRUE(run.report["alarms"].empty()) << run.report["alarms"].dump();
  const TraceFile trace(scratch.path("t.csv"));
  EXPECT_NEAR(trace.at(trace.rows() - 1, trace.column("X.cmd")), 3.0, 0.01);
}

TEST(Waits, are_said_in_the_language_of_the_user) {
  const Scratch scratch;
  const GivenUp run = give_up(scratch, mill_file(), "N10 (WAI,SA20=1)\nN20 M30\n", {"--patience", "2"},
                              {{"LANG", "ru_RU.UTF-8"}});
  EXPECT_EQ(run.ending.code, 1);
  EXPECT_TRUE(
      says(run.ending, "строка 1 в waits.nc: программа ждёт, пока cycle_start (SA20.BL) = 1; сейчас 0"))
      << run.ending.err;
  EXPECT_TRUE(says(run.ending, "прогон остановлен")) << run.ending.err;
}

TEST(Waits, for_an_open_door_are_none_for_the_program_is_not_begun) {
  const Scratch scratch;
  const GivenUp run = give_up(scratch, changed_mill(scratch, "door_closed = 1", "door_closed = 0"),
                              "N10 G90 G94 G71\nN20 G1 X20 F3000\nN30 M30\n", {"--patience", "2"});
  EXPECT_EQ(run.ending.code, 1);
  EXPECT_FALSE(run.report.contains("wait"));
  EXPECT_TRUE(
      says(run.ending, "the control refuses: X: the PLC does not permit motion: X.feed_enable is FALSE"))
      << run.ending.err;
}

TEST(Waits, at_an_override_of_zero_and_at_M00_end_too) {
  const Scratch scratch;
  const GivenUp zero =
      give_up(scratch, mill_file(), "N10 G0 X20\nN20 M30\n", {"--override", "0", "--patience", "2"});
  EXPECT_EQ(zero.ending.code, 1);
  EXPECT_EQ(zero.report["wait"]["reason"], "override_zero");
  EXPECT_TRUE(says(zero.ending, "the operator's feed override is 0 %")) << zero.ending.err;
  EXPECT_TRUE(says(zero.ending, "--override")) << zero.ending.err;
  const GivenUp stop = give_up(scratch, mill_file(), "N10 G0 X2\nN20 M0\nN30 M30\n", {"--patience", "2"});
  EXPECT_EQ(stop.ending.code, 1);
  EXPECT_TRUE(says(stop.ending, "line 2 of waits.nc: the program stands at M00")) << stop.ending.err;
  EXPECT_TRUE(says(stop.ending, "`servogate run` has no operator")) << stop.ending.err;
}

TEST(Waits, that_end_by_themselves_are_none) {
  const Scratch scratch;
  const GivenUp run =
      give_up(scratch, mill_file(), "N10 G0 X2\nN20 TMR=5\nN30 G4\nN40 T1.1 M6\nN50 S3000 M3\nN60 M30\n",
              {"--patience", "0.3", "-q"});
  EXPECT_EQ(run.ending.code, 0) << run.ending.err;
  EXPECT_FALSE(run.report.contains("wait"));
}

TEST(Waits, for_ever_with_a_patience_of_zero_until_the_operator_stops_them) {
  const Scratch scratch;
  Program run({"run", mill_file(), scratch.write("w.nc", "N10 (WAI,SA20=1)\nN20 M30\n"), "--patience", "0",
               "--trace", scratch.path("t.csv")});
  // Homing takes some 6 s of machine time; 100 s of it are 100000 rows.
  ASSERT_TRUE(tests::comes([&] {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(scratch.path("t.csv"), ignored);
    return !ignored && size > 250 * 100000;
  }));
  run.signal(SIGINT);
  const Ending e = run.wait();
  EXPECT_EQ(e.code, 3) << e.err;
  EXPECT_TRUE(says(e, "line 1 of w.nc: the program waits until cycle_start (SA20.BL) = 1")) << e.err;
  EXPECT_FALSE(says(e, "gave-up")) << e.err;
}

TEST(Waits, end_in_real_time_on_a_machine_where_nothing_is_real) {
  const Scratch scratch;
  const GivenUp run = give_up(scratch, mill_file(), "N10 (WAI,SA20=1)\nN20 M30\n",
                              {"--patience", "1", "--realtime=best-effort"});
  EXPECT_EQ(run.ending.code, 1) << run.ending.err;
  EXPECT_EQ(run.report["wait"]["reason"], "signal") << run.ending.err;
}

TEST(Waits, of_a_wrong_patience_are_wrong_use) {
  for (const char* patience : {"-1", "long", "nan"})
    EXPECT_EQ(
        servogate({"run", mill_file(), source("examples/mill/bracket.nc"), "--patience", patience}).code, 2)
        << patience;
}

TEST(Words, of_a_program_error_stand_in_the_alarm_with_file_line_and_column) {
  const Scratch scratch;
  // Found when the block is executed, for a signal has its part in it: X would leave its travel.
  const GivenUp run = give_up(scratch, mill_file(),
                              "N10 G90 G71 G94\nN20 G1 X20 F6000\nN30 E30=SA20+400\nN40 XE30\nN50 M30\n");
  EXPECT_EQ(run.ending.code, 1);
  EXPECT_TRUE(says(run.ending, "alarm 4001: program error in line 4: ")) << run.ending.err;
  EXPECT_TRUE(says(run.ending, "waits.nc:4:")) << run.ending.err;
  EXPECT_TRUE(says(run.ending, "[P701]")) << run.ending.err;
  const json& alarm = run.report["alarms"][0];
  EXPECT_NE(alarm["text"].get<std::string>().find("[P701]"), std::string::npos) << alarm.dump();
  EXPECT_EQ(alarm["finding"]["code"], "P701");
  EXPECT_EQ(alarm["finding"]["line"], 4);
  EXPECT_FALSE(alarm.contains("value")) << "the number of the finding says nothing to people";
}

TEST(Words, of_the_program_are_said_when_it_reaches_them) {
  const Scratch scratch;
  const GivenUp run =
      give_up(scratch, mill_file(), "N10 (DIS,\"FIRST\")\nN20 G0 X2\nN30 (DIS,\"SECOND\")\nN40 M30\n");
  EXPECT_EQ(run.ending.code, 0) << run.ending.err;
  const std::size_t first = run.ending.err.find("message of the program: FIRST");
  const std::size_t second = run.ending.err.find("message of the program: SECOND");
  EXPECT_TRUE(first < second && second != std::string::npos) << run.ending.err;
}

TEST(Blocks, done_are_those_of_the_machine_and_the_expected_ones_are_said_to_be_about) {
  const Scratch scratch;
  const std::string program =
      "N10 (BEQ,SA16,1,GO)\nN20 E1=1\nN30 E2=2\n\"GO\"N40 G0 X2\nN50 (WAI,SA20=1)\nN60 X4\nN70 M30\n";
  const GivenUp run = give_up(scratch, mill_file(), program, {"--patience", "1"});
  EXPECT_EQ(run.report["blocks"], 3) << "N10, N40, N50: what is read ahead does not count";
  EXPECT_EQ(run.report["blocks_expected"], 7) << "the dry run does not see the door closed";
  EXPECT_TRUE(says(run.ending, "broken off: 3 of about 7 blocks")) << run.ending.err;
}

TEST(Alarms, of_a_stuck_axis_say_the_torque_that_its_drive_reports_or_that_it_reports_none) {
  const Scratch scratch;
  // X runs against a rigid stop; the second drive has its torque in a process data object of its own.
  std::string machine =
      read_all(changed_mill(scratch, "start = \"37.5 mm\"", "start = \"37.5 mm\"\nend_stop_max = \"60 mm\""));
  const auto replace = [&machine](const std::string& from, const std::string& to) {
    const std::size_t at = machine.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    machine.replace(at, from.size(), to);
  };
  const char* program = "N10 G90 G71 G94\nN20 G1 X100 F3000\nN30 M30\n";
  const auto sentence = [](const GivenUp& run) {
    for (const json& alarm : run.report["alarms"])
      if (alarm["number"] == 1001 && alarm["axis"] == "X") return alarm["text"].get<std::string>();
    return run.report["alarms"].dump();
  };
  const GivenUp silent = give_up(scratch, scratch.write("silent.toml", machine), program);
  EXPECT_EQ(silent.ending.code, 1) << silent.ending.err;
  EXPECT_NE(sentence(silent).find("and a torque that the drive does not report"), std::string::npos)
      << sentence(silent);

  std::filesystem::create_directory(scratch.path("devices"));
  scratch.write("devices/servo-torque.toml",
                read_all(source("devices/servo-cia402.toml")) +
                    "\n[[tpdo]]\nnumber = 2\ntransmission = 1\nobjects = [\"6077:00/16\"]\n");
  replace("cycle_time = \"1 ms\"", "cycle_time = \"2 ms\"");
  replace("device = \"servo-cia402\"", "device = \"servo-torque\"");
  const GivenUp told = give_up(scratch, scratch.write("told.toml", machine), program, {},
                               {{"SERVOGATE_DEVICES", scratch.path("devices")}});
  EXPECT_EQ(told.ending.code, 1) << told.ending.err;
  const std::string text = sentence(told);
  const std::size_t end = text.find(" ‰ of the rated torque"), begin = text.rfind(' ', end - 1);
  ASSERT_NE(end, std::string::npos) << text;
  EXPECT_GT(std::stod(text.substr(begin)), 1000.0) << "it pushes as hard as it may: " << text;
}

}  // namespace
}  // namespace servogate::machine_run
