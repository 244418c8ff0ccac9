// SPDX-License-Identifier: Apache-2.0
// The way back into a stopped program through the command line: after a stop in the cut, and after kill -9.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Restart : public ::testing::Test {
 protected:
  void up() {
    shell_.up("mill", {"--virtual", "--speed", "20", "--state", (shell_.folder() / "state").string()});
    shell_.ready();
  }
  Outcome run(const std::vector<std::string>& words) { return shell_.run(words); }
  Outcome good(const std::vector<std::string>& words) {
    Outcome o = run(words);
    EXPECT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
    return o;
  }
  std::string write(const char* name, const std::string& text) {
    const std::string path = (shell_.folder() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  double at(int axis) { return shell_.status()["axes"][static_cast<std::size_t>(axis)]["command"]; }
  /// A slow cut along X in line 4, then along Y.
  std::string pocket() {
    return write(
        "pocket.nc",
        "N10 G0 X0 Y0 Z0\nN20 S1200 M3\nN30 G1 Z-5 F500\nN40 X80 F300\nN50 Y20 F3000\nN60 G0 Z0\nN70 M30\n");
  }
  void cut_until_stopped() {
    good({"load", pocket()});
    good({"start"});
    ASSERT_TRUE(shell_.until([](const json& s) { return s["line"] == 4 && s["axes"][0]["command"] > 5.0; }));
  }

  Shell shell_;
};

TEST_F(Restart, goes_on_in_the_block_that_a_quick_stop_interrupted) {
  up();
  EXPECT_TRUE(contains(run({"start", "--interrupted", "--yes"}).err, "no program was interrupted"));
  cut_until_stopped();
  shell_.ask({{"cmd", "quick_stop"}});
  ASSERT_TRUE(shell_.until(
      [](const json& s) { return s["state"] == "stopped_by_alarm" && !s["axes"][0]["moving"]; }));
  const double stopped = at(0);
  EXPECT_LT(stopped, 79.0);
  good({"reset"});
  good({"power", "on"});
  good({"jog", "Z", "+4mm"});
  const Outcome plan = run({"start", "--interrupted"});
  EXPECT_EQ(plan.exit, 2) << "nobody can be asked";
  EXPECT_TRUE(contains(plan.out, "begins at line 4 of")) << plan.out;
  EXPECT_TRUE(contains(plan.out, "N40 X80 F300")) << plan.out;
  EXPECT_TRUE(contains(plan.out, "1. spindle M3 at 1200 rpm")) << plan.out;
  EXPECT_TRUE(contains(plan.err, "say --yes")) << plan.err;
  EXPECT_NEAR(at(0), stopped, 1e-6) << "the plan moves nothing";
  good({"start", "--interrupted", "--yes", "--feed", "2000", "--wait"});
  EXPECT_EQ(shell_.status()["state"], "ended");
  EXPECT_NEAR(at(0), 80.0, 1e-6);
  EXPECT_NEAR(at(1), 20.0, 1e-6);
  EXPECT_TRUE(contains(run({"start", "--interrupted", "--yes"}).err, "no program was interrupted"));
}

TEST_F(Restart, begins_at_a_block_by_its_number_or_line_and_only_once) {
  up();
  good({"load", pocket()});
  good({"start", "--from", "N50", "--yes", "--wait"});
  EXPECT_NEAR(at(0), 80.0, 1e-6) << "where the block begins";
  EXPECT_NEAR(at(1), 20.0, 1e-6);
  EXPECT_EQ(shell_.status()["blocks_done"], 7) << "blocks count as in the whole program";
  good({"start"});
  ASSERT_TRUE(shell_.until([](const json& s) { return s["line"] == 4; }))
      << "the next start is the whole program's";
  good({"reset"});
  EXPECT_TRUE(contains(run({"start", "--from", "N55", "--yes"}).err, "has no block N55"));
  EXPECT_TRUE(contains(run({"start", "--from", "five", "--yes"}).err, "'five' is not a block"));
}

TEST_F(Restart, is_refused_with_another_tool_in_the_spindle) {
  up();
  good({"load", write("tool.nc", "N10 T2.2 M6\nN20 G0 X10\nN30 X20\nN40 M30\n")});
  const Outcome o = run({"start", "--from", "N30", "--yes"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "works with tool 2, and tool 0 is in the spindle")) << o.err;
}

TEST_F(Restart, knows_the_interrupted_block_after_kill_minus_9) {
  up();
  cut_until_stopped();
  shell_.end(SIGKILL);
  up();
  EXPECT_TRUE(contains(run({"start", "--interrupted", "--yes"}).err, "load it first"));
  good({"load", pocket()});
  const Outcome plan = run({"start", "--interrupted"});
  EXPECT_TRUE(contains(plan.out, "begins at line 4 of")) << plan.out << plan.err;
  good({"start", "--interrupted", "--yes", "--feed", "2000", "--wait"});
  EXPECT_NEAR(at(1), 20.0, 1e-6);
}

}  // namespace
}  // namespace servogate::gateway::testing
