// SPDX-License-Identifier: Apache-2.0
// Captures of a machine: `--capture` of run and up, `servogate capture`, and the black box of a control.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// Columns of a CSV file, by name; times in `t`.
std::map<std::string, std::vector<double>> columns(const std::string& text) {
  std::map<std::string, std::vector<double>> out;
  std::istringstream lines(text);
  std::string line, field;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream fields(line); std::getline(fields, field, ',');) names.push_back(field);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    for (std::size_t n = 0; std::getline(fields, field, ','); ++n)
      out[names.at(n)].push_back(std::stod(field));
  }
  return out;
}

class Capture : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return (shell_.folder() / name).string(); }
  Outcome run(std::vector<std::string> more) {
    std::ofstream(file("p.nc")) << "G1 X20 Y10 F3000\nS1000 M3\nX0\nM5\nM30\n";
    std::vector<std::string> words{"run", Shell::example("mill/machine.toml"), file("p.nc"), "--virtual",
                                   "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return shell_.run(words);
  }
  json about(const std::string& name) {
    const Outcome o = shell_.run({"capture", file(name), "--json"});
    EXPECT_EQ(o.exit, 0) << o.err;
    return json::parse(o.out);
  }

  Shell shell_;
};

TEST_F(Capture, holds_axes_points_words_of_the_interface_and_variables_of_the_plc_of_every_cycle) {
  const Outcome o = run({"--trace", file("t.csv"), "--capture", file("a.mcap"), "--channels",
                         "X.cmd,X.act,X.error,spindle.act,feed,line,S.at_speed,Mill.spindle_on,SK10,alarms"});
  ASSERT_EQ(o.exit, 0) << o.err;
  const Outcome made = shell_.run({"capture", file("a.mcap"), "--csv", file("a.csv")});
  ASSERT_EQ(made.exit, 0) << made.err;
  const auto trace = columns(shell_.text("t.csv")), capture = columns(shell_.text("a.csv"));
  ASSERT_EQ(capture.size(), 11u);
  for (const char* name : {"X.cmd", "X.act", "spindle.act", "feed", "line", "S.at_speed"}) {
    const auto &a = capture.at(name), &b = trace.at(name);
    ASSERT_EQ(a.size(), b.size()) << name;
    for (std::size_t n = 0; n < a.size(); ++n) ASSERT_NEAR(a[n], b[n], 1e-6) << name << ' ' << n;
  }
  const auto &on = capture.at("Mill.spindle_on"), &speed = capture.at("spindle.act");
  EXPECT_EQ(*std::max_element(on.begin(), on.end()), 1.0);
  EXPECT_NEAR(*std::max_element(speed.begin(), speed.end()), 1000.0, 20.0);
  EXPECT_TRUE(std::filesystem::exists(file("a.csv.frames.csv"))) << "the frames of the bus are there, too";
}

TEST_F(Capture, of_two_virtual_runs_is_equal_byte_by_byte_and_as_csv_what_its_mcap_becomes) {
  ASSERT_EQ(run({"--capture", file("a.mcap")}).exit, 0);
  ASSERT_EQ(run({"--capture", file("b.mcap")}).exit, 0);
  ASSERT_EQ(run({"--capture", file("c.csv")}).exit, 0);
  EXPECT_TRUE(shell_.text("a.mcap") == shell_.text("b.mcap"));
  ASSERT_EQ(shell_.run({"capture", file("a.mcap"), "--csv", file("a.csv")}).exit, 0);
  EXPECT_TRUE(shell_.text("a.csv") == shell_.text("c.csv"));
  EXPECT_TRUE(shell_.text("a.csv.frames.csv") == shell_.text("c.csv.frames.csv"));
}

TEST_F(Capture, begins_before_its_trigger_and_ends_behind_it) {
  ASSERT_EQ(run({"--capture", file("a.mcap"), "--channels", "X.cmd", "--trigger", "X.cmd > 15", "--before",
                 "0.2", "--after", "0.1"})
                .exit,
            0);
  const json a = about("a.mcap");
  EXPECT_EQ(a["rows"], 301);
  ASSERT_EQ(a["notes"].size(), 1u);
  EXPECT_EQ(a["notes"][0]["text"], "X.cmd > 15");
  EXPECT_NEAR(a["notes"][0]["t_s"].get<double>() - a["from_s"].get<double>(), 0.2, 1e-9);
  EXPECT_GT(a["frames"].get<int>(), 300);
  EXPECT_EQ(a["origin"]["machine"], "Three-axis mill");
  EXPECT_LT(a["channels"][0]["least"].get<double>(), 15.0);
  EXPECT_GT(a["channels"][0]["most"].get<double>(), 15.0);
}

TEST_F(Capture, whose_trigger_does_not_come_leaves_no_file_and_says_so) {
  const Outcome o = run({"--capture", file("a.mcap"), "--trigger", "X.cmd > 1000"});
  EXPECT_EQ(o.exit, 0);
  EXPECT_TRUE(contains(o.err, "the trigger did not come")) << o.err;
  EXPECT_FALSE(std::filesystem::exists(file("a.mcap")));
}

TEST_F(Capture, of_everything_holds_everything_that_has_a_number) {
  ASSERT_EQ(run({"--capture", file("a.mcap"), "--channels", "all"}).exit, 0);
  const json a = about("a.mcap");
  EXPECT_GT(a["channels"].size(), 200u);
  std::size_t axes = 0;
  for (const json& c : a["channels"]) axes += c["name"].get<std::string>().starts_with("X.") ? 1 : 0;
  EXPECT_GE(axes, 16u);
}

TEST_F(Capture, that_cannot_be_made_is_refused_before_anything_moves) {
  const struct {
    std::vector<std::string> words;
    const char* said;
  } rows[] = {
      {{"--capture", file("a.txt")}, "ends neither with .csv nor with .mcap"},
      {{"--capture", file("a.csv"), "--channels", "X.errors"}, "X.errors: this machine has no such value"},
      {{"--capture", file("a.csv"), "--trigger", "X.error is big"}, "is no condition"},
      {{"--capture", file("a.csv"), "--trigger", "Q.error > 1"}, "Q.error: this machine has no such value"},
      {{"--trigger", "alarm"}, "need --capture FILE"},
      {{"--capture", file("a.csv"), "--channels", ","}, "is nothing on this machine"},
      {{"--capture", file("a.csv"), "--trigger", "axes > 1"}, "axes is a group"},
      {{"--capture", file("a.csv"), "--trigger", "alarm > 0"}, "or alarm alone"},
      {{"--capture", file("a.csv"), "--channels", "all", "--trigger", "alarm", "--before", "3600"}, " MB"},
      {{"--capture", "/nowhere/a.csv"}, "/nowhere"}};
  for (const auto& row : rows) {
    const Outcome o = run(row.words);
    EXPECT_TRUE(o.exit == 2 || o.exit == 4) << o.exit;
    EXPECT_TRUE(contains(o.err, row.said)) << row.said << '\n' << o.err;
    EXPECT_FALSE(std::filesystem::exists(file("a.csv")));
  }
}

TEST_F(Capture, that_was_cut_off_is_read_as_far_as_it_goes) {
  ASSERT_EQ(run({"--capture", file("a.mcap")}).exit, 0);
  const std::string whole = shell_.text("a.mcap");
  std::ofstream(file("b.mcap"), std::ios::binary) << whole.substr(0, whole.size() * 2 / 3);
  const Outcome o = shell_.run({"capture", file("b.mcap"), "--json"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_TRUE(contains(o.err, "is damaged at byte")) << o.err;
  EXPECT_GT(json::parse(o.out)["rows"].get<int>(), 100);
  EXPECT_EQ(shell_.run({"capture", file("p.nc")}).exit, 2) << "no capture at all";
}

TEST_F(Capture, of_a_control_is_its_black_box_with_the_seconds_before_each_alarm) {
  shell_.up("mill", {"--virtual", "--speed", "20", "--state", file("state")});
  shell_.ready();
  ASSERT_EQ(shell_.run({"input", "estop_chain_ok", "off"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return !s["alarms"].empty(); }));
  ASSERT_EQ(shell_.run({"down"}).exit, 0);
  std::vector<std::string> files;
  for (const auto& f : std::filesystem::directory_iterator(file("state/blackbox"))) files.push_back(f.path());
  ASSERT_FALSE(files.empty());
  const Outcome o = shell_.run({"capture", files.front(), "--json"});
  ASSERT_EQ(o.exit, 0) << o.err;
  const json box = json::parse(o.out);
  ASSERT_FALSE(box["notes"].empty());
  EXPECT_EQ(box["notes"][0]["text"], "alarm");
  const double alarm = box["notes"][0]["t_s"], from = box["from_s"];
  EXPECT_NEAR(alarm - from, std::min(10.0, alarm), 0.01);
  EXPECT_GT(box["frames"].get<int>(), 1000);
}

}  // namespace
}  // namespace servogate::gateway::testing
