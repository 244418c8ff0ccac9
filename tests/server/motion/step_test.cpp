// SPDX-License-Identifier: Apache-2.0
// STEP, as a person walks through a program with it.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

double x_of(Shell& shell) { return shell.status()["axes"][0]["command"].get<double>(); }

TEST(Step, ends_with_its_block_and_the_next_one_goes_on_from_there) {
  Shell shell;
  shell.up();
  shell.ready();
  const std::string program = (shell.folder() / "walk.nc").string();
  std::ofstream(program) << "G1 X10 F6000\nX10.01\nE1=1\nX30\nM30\n";
  ASSERT_EQ(shell.run({"load", program}).exit, 0);
  const double ends[] = {10.0, 10.01, 30.0};
  const int lines[] = {1, 2, 4};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(shell.run({"step", "--wait"}).exit, 0);
    const json status = shell.status();
    EXPECT_NEAR(status["axes"][0]["command"].get<double>(), ends[i], 1e-9);
    EXPECT_EQ(status["line"], lines[i]) << "the block that has ended is shown";
  }
  EXPECT_EQ(shell.run({"step", "--wait"}).exit, 0);
  EXPECT_EQ(shell.status()["state"], "ended");
}

TEST(Step, runs_one_block_of_functions_as_one_of_motion) {
  Shell shell;
  shell.up();
  shell.ready();
  const std::string program = (shell.folder() / "words.nc").string();
  std::ofstream(program) << "M8\nG1 X5 F6000\nM9\nM0\nX10\nM30\n";
  ASSERT_EQ(shell.run({"load", program}).exit, 0);
  for (const int line : {1, 2, 3, 4, 5}) {
    EXPECT_EQ(shell.run({"step", "--wait"}).exit, 0);
    EXPECT_EQ(shell.status()["line"], line);
  }
  EXPECT_NE(shell.status()["state"], "ended");
  EXPECT_EQ(shell.run({"step", "--wait"}).exit, 0);
  EXPECT_EQ(shell.status()["state"], "ended");
}

TEST(Step, is_refused_for_a_program_that_was_started_as_a_whole_and_is_held) {
  Shell shell;
  shell.up();
  shell.ready();
  const std::string program = (shell.folder() / "whole.nc").string();
  std::ofstream(program) << "G1 X100 F30\nX0\nM30\n";
  ASSERT_EQ(shell.run({"load", program}).exit, 0);
  ASSERT_EQ(shell.run({"start"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["axes"][0]["command"] > 1.0; }));
  ASSERT_EQ(shell.run({"hold"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["state"] == "held"; }));
  const double held = x_of(shell);
  const Outcome refused = shell.run({"step"});
  EXPECT_EQ(refused.exit, 1);
  EXPECT_NE(refused.err.find("servogate resume"), std::string::npos) << refused.err;
  EXPECT_EQ(x_of(shell), held);
}

TEST(Step, takes_its_blocks_one_at_a_time_from_MDI_too) {
  Shell shell;
  shell.up();
  shell.ready();
  const Outcome two = shell.run({"mdi", "G0 X1\nG0 X2"});
  EXPECT_EQ(two.exit, 2);
  EXPECT_NE(two.err.find("more than one line"), std::string::npos) << two.err;
  EXPECT_EQ(x_of(shell), 0.0);
}

}  // namespace
}  // namespace servogate::gateway::testing
