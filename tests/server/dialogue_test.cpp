// SPDX-License-Identifier: Apache-2.0
// What stands for keyboard input and record files of an old control: messages, waits, and places that clients
// set.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Dialogue : public ::testing::Test {
 protected:
  void begin(const std::string& program) {
    shell_.up("mill", {"--virtual", "--speed", "20"});
    shell_.ready();
    start(program);
  }
  void start(const std::string& program) {
    const std::string file = (shell_.folder() / "asks.nc").string();
    std::ofstream(file) << program;
    ASSERT_EQ(run({"load", file}).exit, 0);
    ASSERT_EQ(run({"start"}).exit, 0);
  }
  Outcome run(std::vector<std::string> words) {
    words.insert(words.end(), {"--socket", shell_.socket()});
    return shell_.run(words);
  }
  bool ended() {
    return shell_.until([](const json& s) { return s["state"] == "ended"; });
  }

  Shell shell_;
};

TEST_F(Dialogue, is_a_message_a_wait_and_a_place_that_the_operator_sets) {
  begin("(DIS,\"FEED = ?\")\n(WAI,SK220=1)\nE30=SK56.RE\nSK221=2\nG1 X10 FE30\nM0\nM30\n");
  ASSERT_TRUE(
      shell_.until([](const json& s) { return s["wait"].is_object() && s["message"] == "FEED = ?"; }));
  EXPECT_EQ(run({"plc", "force", "SK56.RE=250", "--stay"}).exit, 0);
  EXPECT_EQ(run({"plc", "force", "SK220=1", "--stay"}).exit, 0);
  ASSERT_TRUE(
      shell_.until([](const json& s) { return s["state"] == "waiting" && s["wait"]["reason"] != "signal"; }));
  EXPECT_NEAR(shell_.status()["axes"][0]["command"].get<double>(), 10.0, 1e-6);
}

TEST_F(Dialogue, of_values_outlives_the_program_that_wrote_them) {
  begin("SYVAR3.LR=12.5\nSK222=7\nM30\n");
  ASSERT_TRUE(ended());
  start("E30=SYVAR3.LR\nG0 XE30\nM30\n");
  ASSERT_TRUE(ended());
  EXPECT_NEAR(shell_.status()["axes"][0]["command"].get<double>(), 12.5, 1e-6);
  EXPECT_TRUE(shell_.plc_becomes("SK222", 7));
}

}  // namespace
}  // namespace servogate::gateway::testing
