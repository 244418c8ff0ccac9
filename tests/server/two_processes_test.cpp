// SPDX-License-Identifier: Apache-2.0
// Two processes of one machine through the command line: X is the first one's, Y the second one's.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class TwoProcesses : public ::testing::Test {
 protected:
  TwoProcesses() {
    std::string machine = read("minimal/machine.toml"), logic = read("minimal/minimal.st");
    replace(machine, "minimal machine", "three-axis mill");
    replace(machine, "[control]\n", "[control]\nprocesses = 2\npower_on = [\"G94\"]\n");
    replace(machine, "letter = \"Y\"\n", "letter = \"Y\"\nprocess = 2\n");
    replace(logic, "  NC.feed_enable := TRUE;\n",
            "  NC.feed_enable := TRUE;\n  NC2.feed_enable := TRUE;\n  NC2.read_in_enable := TRUE;\n"
            "  NC2.m_ack := NC2.m_strobe;\n");
    write("machine.toml", machine);
    write("minimal.st", logic);
  }
  void begin() {
    shell_.up_file(file("machine.toml"), {"--virtual", "--speed", "20"});
    ASSERT_EQ(good({"power", "on"}), 0);
  }
  static std::string read(const std::string& example) {
    std::ifstream in(Shell::example(example));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }
  std::string write(const char* name, const std::string& text) {
    std::ofstream(file(name)) << text;
    return file(name);
  }
  Outcome run(std::vector<std::string> words) {
    words.insert(words.end(), {"--socket", shell_.socket()});
    return shell_.run(words);
  }
  int good(const std::vector<std::string>& words) {
    const Outcome o = run(words);
    EXPECT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
    return o.exit;
  }
  json process(int n) { return shell_.status()["processes"][static_cast<std::size_t>(n - 1)]; }
  bool until_state(int n, const std::string& state) {
    return shell_.until(
        [&](const json& s) { return s["processes"][static_cast<std::size_t>(n - 1)]["state"] == state; });
  }
  double at(int axis) { return shell_.status()["axes"][static_cast<std::size_t>(axis)]["command"]; }

  Shell shell_;
};

TEST_F(TwoProcesses, each_load_start_and_hold_a_program_of_their_own) {
  begin();
  const std::string x = write("x.nc", "N10 G1 X200 F600\nN20 M30\n"),
                    y = write("y.nc", "N10 G1 Y150 F600\nN20 M30\n");
  good({"load", x});
  good({"load", y, "--process", "2"});
  EXPECT_EQ(process(1)["program"], x);
  EXPECT_EQ(process(2)["program"], y);
  good({"start"});
  good({"start", "--process", "2"});
  ASSERT_TRUE(shell_.until(
      [](const json& s) { return s["axes"][0]["moving"] == true && s["axes"][1]["moving"] == true; }));
  good({"hold", "--process", "2"});
  ASSERT_TRUE(until_state(2, "held"));
  EXPECT_EQ(process(1)["state"], "running") << "a hold of the second one does not hold the first";
  const std::string words = run({"status"}).out;
  EXPECT_TRUE(contains(words, "process 1: auto, running")) << words;
  EXPECT_TRUE(contains(words, "process 2: auto, held")) << words;
  good({"resume", "--process", "2"});
  ASSERT_TRUE(until_state(1, "ended"));
  ASSERT_TRUE(until_state(2, "ended"));
  EXPECT_NEAR(at(0), 200.0, 1e-6);
  EXPECT_NEAR(at(1), 150.0, 1e-6);
}

TEST_F(TwoProcesses, take_a_typed_block_each_and_wait_for_their_own) {
  begin();
  EXPECT_EQ(good({"mdi", "G0 Y12", "--process", "2", "--wait"}), 0);
  EXPECT_NEAR(at(1), 12.0, 1e-6);
  EXPECT_EQ(process(1)["state"], "idle");
  const Outcome foreign = run({"mdi", "G0 Y13"});
  EXPECT_NE(foreign.exit, 3);
  EXPECT_NEAR(at(1), 12.0, 1e-6) << "Y is not the first one's";
  EXPECT_EQ(run({"start", "--process", "3"}).exit, 1);
  EXPECT_EQ(run({"start", "--process", "9"}).exit, 2);
}

TEST_F(TwoProcesses, see_the_variables_that_the_other_one_writes) {
  begin();
  good({"load", write("reads.nc", "(WAI,SYVAR5=7)\n(WAI,SK20=3)\nG1 Y15 F6000\nM30\n"), "--process", "2"});
  good({"load", write("writes.nc", "G1 X5 F6000\n#SYVAR5=7\nSK20=3\nM30\n")});
  good({"start", "--process", "2"});
  ASSERT_TRUE(until_state(2, "waiting"));
  EXPECT_NEAR(at(1), 0.0, 1e-6);
  good({"start"});
  ASSERT_TRUE(until_state(1, "ended"));
  ASSERT_TRUE(until_state(2, "ended"));
  EXPECT_NEAR(at(1), 15.0, 1e-6);
}

TEST_F(TwoProcesses, read_the_records_that_a_program_of_the_other_one_has_written) {
  const std::string record = file("records.record"), state = file("state");
  shell_.up_file(file("machine.toml"), {"--virtual", "--speed", "20", "--state", state, "--record", record});
  good({"power", "on"});
  const std::string reads = write("reads.nc", "(DER,1,E40)\n(OPN,1,PTS)\n(RED,1,1,2)\nG1 XE40 F6000\nM30\n");
  const Outcome early = run({"load", reads});
  EXPECT_EQ(early.exit, 1);
  EXPECT_TRUE(contains(early.err, "there is no such file")) << early.err;
  good({"load",
        write("writes.nc",
              "(DER,1,E40)\n(CRE,1,PTS,2)\n(OPN,1,PTS,W)\nG1 Y5 F6000\nE40=15.25\n(WRT,1,1,2)\nM30\n"),
        "--process", "2"});
  good({"start", "--process", "2"});
  ASSERT_TRUE(until_state(2, "ended"));
  good({"load", reads});
  good({"start", "--wait"});
  EXPECT_NEAR(at(0), 15.25, 1e-6);
  good({"down"});
  std::ifstream kept(state + "/records.toml");
  const std::string words{std::istreambuf_iterator<char>(kept), {}};
  EXPECT_TRUE(contains(words, "name = \"PTS\"\ncapacity = 2\nfields = [\"LR\"]\n")) << words;
  EXPECT_TRUE(contains(words, "{ number = 2, items = [15.25] }")) << words;
  const std::string trace = file("replay.csv");
  const Outcome replay = shell_.run({"replay", record, "--trace", trace});
  EXPECT_EQ(replay.exit, 0) << replay.out << replay.err;
  std::ifstream rows(trace);
  const std::string all{std::istreambuf_iterator<char>(rows), {}};
  EXPECT_TRUE(contains(all, ",15.25")) << "the record holds what was read";
}

TEST_F(TwoProcesses, carry_over_what_each_program_changed_and_nothing_that_it_was_given) {
  const std::string state = file("state");
  shell_.up_file(file("machine.toml"), {"--virtual", "--speed", "20", "--state", state});
  good({"power", "on"});
  write("SLV", "(WAI,1)\nM30\n");
  good({"load", write("starts.nc",
                      "(DER,1,E40)\n(CRE,1,PTS,3)\n(OPN,1,PTS,W)\nE40=1.25\n(WRT,1,1,1)\n(EXE,2,SLV)\n"
                      "#(SND,2)\nE40=2.5\n(WRT,1,1,1)\nM30\n")});
  good({"start", "--wait"});
  ASSERT_TRUE(until_state(2, "ended"));
  good({"down"});
  std::ifstream kept(state + "/records.toml");
  const std::string words{std::istreambuf_iterator<char>(kept), {}};
  EXPECT_TRUE(contains(words, "{ number = 1, items = [2.5] }")) << words;
}

TEST_F(TwoProcesses, read_how_far_the_axes_of_the_other_one_still_have_to_go) {
  begin();
  good({"load", write("far.nc", "G1 X200 F3000\nM30\n")});
  good({"load",
        write("watches.nc", "\"A\"E30=RMN11\n(BEQ,E30,0,A)\n(BGT,E30,100,A)\nG1 Y10 F6000\nM0\nM30\n"),
        "--process", "2"});
  good({"start", "--process", "2"});
  good({"start"});
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][1]["command"] > 0.0; }));
  EXPECT_GT(at(0), 99.0) << "Y waited until X had 100 mm to go";
  ASSERT_TRUE(until_state(1, "ended"));
}

TEST_F(TwoProcesses, start_programs_in_each_other_and_replay_it_from_the_record) {
  const std::string record = file("pair.record");
  shell_.up_file(file("machine.toml"), {"--virtual", "--speed", "20", "--record", record});
  good({"power", "on"});
  const std::string second = write("s1.nc", "G1 Y15 F6000\n#(SND,1)\n(WAI,1)\nG1 Y10\n(REL)\n");
  write("s2.nc", "G1 Y20 F6000\n(REL)\n");
  const std::string first =
      write("main.nc", "(EXE,2,S1)\n(WAI,2)\nG1 X5 F6000\nM0\n(SND,2)\n(EXE,2,S2)\nM30\n");
  good({"load", first});
  good({"start"});
  ASSERT_TRUE(until_state(1, "waiting"));
  ASSERT_TRUE(until_state(2, "waiting"));
  EXPECT_NEAR(at(1), 15.0, 1e-6);
  ASSERT_TRUE(shell_.until([&](const json& s) { return s["processes"][1]["program"] == second; }));
  const std::string words = run({"status"}).out;
  EXPECT_TRUE(contains(words, "line 3 of s1.nc: the program waits until process 1 sends it on")) << words;
  ASSERT_TRUE(
      shell_.until([&](const json& s) { return s["processes"][0]["wait"]["reason"] == "program_stop"; }));
  good({"start"});
  ASSERT_TRUE(until_state(1, "ended"));
  ASSERT_TRUE(shell_.until([&](const json& s) { return s["axes"][1]["command"] == 20.0; }));
  ASSERT_TRUE(shell_.until([&](const json& s) { return s["processes"][1]["program"] == ""; })) << "unloaded";
  EXPECT_EQ(run({"start", "--process", "2"}).exit, 1);
  good({"down"});
  const std::string trace = file("replay.csv");
  const Outcome replay = shell_.run({"replay", record, "--trace", trace});
  EXPECT_EQ(replay.exit, 0) << replay.out << replay.err;
  std::ifstream rows(trace);
  std::string header, last;
  std::getline(rows, header);
  bool waited = false;
  for (std::string row; std::getline(rows, row); last = row) waited = waited || contains(row, "15.000");
  EXPECT_TRUE(waited) << header;
  EXPECT_TRUE(contains(last, "20.000")) << header << "\n" << last;
}

TEST_F(TwoProcesses, refuse_a_program_with_an_axis_of_the_other_in_check_and_load_alike) {
  const std::string x = write("x.nc", "N10 G1 X20 F600\nN20 M30\n");
  const std::string why = "X belongs to another process";
  EXPECT_EQ(shell_.run({"check", file("machine.toml"), x}).exit, 0);
  const Outcome checked = shell_.run({"check", file("machine.toml"), x, "--process", "2"});
  EXPECT_EQ(checked.exit, 1);
  EXPECT_TRUE(contains(checked.out + checked.err, why)) << checked.out << checked.err;
  EXPECT_EQ(shell_.run({"check", file("machine.toml"), x, "--process", "3"}).exit, 2);
  begin();
  const Outcome loaded = run({"load", x, "--process", "2"});
  EXPECT_EQ(loaded.exit, 1);
  EXPECT_TRUE(contains(loaded.err, why)) << loaded.err;
}

TEST_F(TwoProcesses, hand_an_axis_over_with_what_is_loaded_proven_again) {
  begin();
  const std::string x = write("x.nc", "N10 G1 X120 F600\nN15 X119\nN20 M30\n");
  good({"load", x});
  good({"start"});
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["moving"] == true; }));
  const Outcome early = run({"assign", "X", "--process", "2"});
  EXPECT_EQ(early.exit, 1) << "while its program runs";
  ASSERT_TRUE(until_state(1, "ended"));
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["in_position"] == true; }));
  good({"assign", "X", "--process", "2"});
  EXPECT_EQ(shell_.status()["axes"][0]["process"], 2);
  const Outcome again = run({"start"});
  EXPECT_EQ(again.exit, 1) << "the first one's program has lost its axis";
  EXPECT_TRUE(contains(again.err, "X belongs to another process")) << again.err;
  const std::string both = write("both.nc", "N10 G1 X10 Y20 F6000\nN20 M30\n");
  good({"load", both, "--process", "2"});
  EXPECT_EQ(good({"start", "--process", "2", "--wait"}), 0);
  EXPECT_NEAR(at(0), 10.0, 1e-6);
  EXPECT_NEAR(at(1), 20.0, 1e-6);
}

TEST_F(TwoProcesses, know_each_others_origins_as_soon_as_a_program_has_ended) {
  begin();
  good({"zero", "Y", "5"});
  EXPECT_EQ(good({"mdi", "G0 Y15", "--process", "2", "--wait"}), 0);
  EXPECT_NEAR(at(1), 10.0, 1e-6);
  good({"assign", "Y", "--process", "1"});
  EXPECT_EQ(good({"mdi", "G0 Y35", "--wait"}), 0);
  EXPECT_NEAR(at(1), 30.0, 1e-6) << "the origin is the machine's, not the process'";
}

}  // namespace
}  // namespace servogate::gateway::testing
