// SPDX-License-Identifier: Apache-2.0
// A record of a run, in virtual or in real time, replays to the same bytes.
#include <gtest/gtest.h>

#include <filesystem>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include "machine/state/state.hpp"
#include "tests/comes.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/machine_run/rig/programs.hpp"

namespace servogate::machine_run {
namespace {

struct Recorded {
  std::string program, record, trace;
  Ending ending;
};

Recorded record(const Scratch& scratch, const std::string& clock, const std::vector<std::string>& more = {}) {
  Recorded r;
  r.program = scratch.write("short.nc", kShortProgram);
  r.record = scratch.path("run.record");
  r.trace = scratch.path("run.csv");
  std::vector<std::string> arguments{
      "run", source("examples/mill/machine.toml"), r.program, clock, "--record", r.record, "--trace", r.trace,
      "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  r.ending = servogate(arguments);
  return r;
}

TEST(Replay, of_a_virtual_run_is_equal_byte_by_byte) {
  const Scratch scratch;
  const Recorded run = record(scratch, "--virtual");
  ASSERT_EQ(run.ending.code, 0) << run.ending.err;
  const Ending replay = servogate({"replay", run.record, "--against", run.trace});
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_NE(replay.err.find("equal byte by byte"), std::string::npos) << replay.err;
}

TEST(Replay, of_a_real_time_run_is_equal_byte_by_byte) {
  const Scratch scratch;
  const Recorded run = record(scratch, "--realtime=best-effort");
  // On a loaded computer a late cycle may stop the run with an alarm; the replay repeats that too.
  ASSERT_TRUE(run.ending.code == 0 || run.ending.code == 1) << run.ending.err;
  const Ending replay = servogate({"replay", run.record, "--against", run.trace, "--json"});
  EXPECT_EQ(replay.code, 0) << replay.err << replay.out;
  EXPECT_NE(replay.out.find("\"first_difference\":0"), std::string::npos) << replay.out;
  std::ifstream trace(run.trace);
  std::string head, row;
  std::getline(trace, head);
  std::getline(trace, row);
  EXPECT_EQ(row.substr(0, 9), "0.000000,") << "the trace does not begin with the run";
}

TEST(Replay, of_a_run_stopped_by_its_operator_in_real_time_is_equal) {
  const Scratch scratch;
  const std::string program =
      scratch.write("long.nc", "N10 G90 G94 G71\nN20 G1 X200 Y150 F3000\nN30 X0\nN40 M30\n");
  Program run({"run", source("examples/mill/machine.toml"), program, "--realtime=best-effort", "--record",
               scratch.path("r"), "--trace", scratch.path("t"), "-q"});
  // Until the run has begun: stopped then, or at any time after, it replays.
  ASSERT_TRUE(tests::comes(
      [&] {
        return std::filesystem::exists(scratch.path("t")) &&
               read_all(scratch.path("t")).find("\n1.") != std::string::npos;
      },
      std::chrono::milliseconds(50)));
  run.signal(SIGINT);
  const Ending ended = run.wait();
  ASSERT_TRUE(ended.code == 3 || ended.code == 1) << ended.code << ended.err;
  const Ending replay = servogate({"replay", scratch.path("r"), "--against", scratch.path("t")});
  EXPECT_EQ(replay.code, 0) << replay.err;
}

TEST(Replay, repeats_the_state_that_the_run_found_not_the_one_it_left) {
  const Scratch scratch;
  const std::string state = scratch.path("state");
  // Each run moves the origin in the state directory on; a replay begins where its own run began.
  machine::MachineState kept;
  kept.tables.origins[1]["X"] = 10.0;
  std::string error;
  ASSERT_TRUE(machine::StateDirectory(state).save_all(kept, error)) << error;
  const std::string program = scratch.write(
      "origin.nc",
      "N10 G90 G94 G71\nN20 (UAO,1)\nN30 G0 X3\nN40 (RQO,1,X4)\nN50 (UAO,1)\nN60 G0 X3\nN70 M30\n");
  const std::vector<std::string> base{
      "run", source("examples/mill/machine.toml"), program, "--virtual", "-q", "--state", state};
  ASSERT_EQ(servogate(base).code, 0);
  std::vector<std::string> recorded = base;
  recorded.insert(recorded.end(), {"--record", scratch.path("r"), "--trace", scratch.path("t")});
  const Ending run = servogate(recorded);
  ASSERT_EQ(run.code, 0) << run.err;
  const Ending replay = servogate({"replay", scratch.path("r"), "--against", scratch.path("t")});
  EXPECT_EQ(replay.code, 0) << replay.err;
}

TEST(Replay, names_the_line_where_a_trace_differs) {
  const Scratch scratch;
  const Recorded run = record(scratch, "--virtual");
  ASSERT_EQ(run.ending.code, 0) << run.ending.err;
  std::string content = read_all(run.trace);
  const std::size_t line_1000 = [&] {
    std::size_t at = 0;
    for (int i = 1; i < 1000; ++i) at = content.find('\n', at) + 1;
    return at;
  }();
  content[content.find('.', line_1000) + 2] ^= 1;
  scratch.write("changed.csv", content);
  const Ending replay = servogate({"replay", run.record, "--against", scratch.path("changed.csv")});
  EXPECT_EQ(replay.code, 1);
  EXPECT_NE(replay.err.find("line 1000 "), std::string::npos) << replay.err;
  const Ending cut =
      servogate({"replay", run.record, "--against", scratch.write("cut.csv", content.substr(0, line_1000))});
  EXPECT_EQ(cut.code, 1);
  EXPECT_NE(cut.err.find("line 1000 "), std::string::npos) << cut.err;
}

TEST(Replay, of_what_is_no_record_or_compared_with_nothing_is_wrong_use) {
  const Scratch scratch;
  for (const char* content : {"", "\n", "{}\n", "[1]\n", "{\"servogate\":\"record\"}\n", "not json\n",
                              "{\"servogate\":\"record\",\"schema\":\"x\"}\n"}) {
    const Ending e = servogate({"replay", scratch.write("r", content)});
    EXPECT_EQ(e.code, 2) << content << e.err;
    EXPECT_NE(e.err.find("cannot replay " + scratch.path("r") + ": "), std::string::npos) << e.err;
    EXPECT_EQ(std::count(e.err.begin(), e.err.end(), '\n'), 1) << e.err;
  }
  EXPECT_EQ(servogate({"replay", scratch.path("none")}).code, 2);
  const Recorded run = record(scratch, "--virtual");
  const Ending against_nothing = servogate({"replay", run.record, "--against", scratch.path("none.csv")});
  EXPECT_EQ(against_nothing.code, 2) << against_nothing.err;
  EXPECT_NE(against_nothing.err.find("none.csv"), std::string::npos) << against_nothing.err;
}

TEST(Replay, says_which_schema_a_record_of_another_version_has) {
  const Scratch scratch;
  const Ending e = servogate({"replay", scratch.write("r", "{\"servogate\":\"record\",\"schema\":1}\n")});
  EXPECT_EQ(e.code, 2);
  EXPECT_NE(e.err.find("it is of schema 1, this version of servogate reads schema 5"), std::string::npos)
      << e.err;
  const Ending empty = servogate({"replay", scratch.write("empty", "")});
  EXPECT_NE(empty.err.find("the file is empty"), std::string::npos) << empty.err;
}

TEST(Replay, of_a_cut_or_changed_record_says_in_one_sentence_where_and_is_wrong_use) {
  const Scratch scratch;
  const Recorded run = record(scratch, "--virtual");
  ASSERT_EQ(run.ending.code, 0) << run.ending.err;
  const std::string whole = read_all(run.record);
  std::string changed = whole;
  changed[whole.size() / 2] ^= 0x10;
  for (const std::string& damaged : {whole.substr(0, whole.size() / 2), changed,
                                     whole.substr(0, whole.size() - 1), whole.substr(0, whole.size() - 8)}) {
    const Ending e =
        servogate({"replay", scratch.write("damaged", damaged), "--against", run.trace, "--json"});
    EXPECT_EQ(e.code, 2) << e.err;
    EXPECT_NE(e.err.find("damaged is damaged at byte "), std::string::npos) << e.err;
    EXPECT_EQ(std::count(e.err.begin(), e.err.end(), '\n'), 1) << "one sentence, not two: " << e.err;
    EXPECT_NE(e.out.find("\"damaged\":true"), std::string::npos) << e.out;
  }
}

}  // namespace
}  // namespace servogate::machine_run
