// SPDX-License-Identifier: Apache-2.0
// A program that can be proven wrong is not loaded; what the machine decides is a warning.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Proof : public ::testing::Test {
 protected:
  Proof() {
    shell_.up();
    shell_.ready();
  }
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (shell_.folder() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  Shell shell_;
};

TEST_F(Proof, refuses_to_load_what_check_finds_wrong_and_keeps_what_was_loaded) {
  const std::string good = file("good.nc", "G90 G0 X5\nM30\n");
  ASSERT_EQ(shell_.run({"load", good}).exit, 0);
  const struct {
    const char *text, *place, *code;
  } wrong[] = {
      {"G90 G0 X10\n  G0 X301\nM30\n", ":2:6: ", "P701"},
      {"G90 G0 X10\n(UAO,77)\nM30\n", ":2:", "P612"},
      {"G90 G0 X10\nG96 S100\nG1 X20 F100\nM30\n", ":2:", "P810"},
      {"G90 G0 X10\nE1=0\nG0 X20\nE2=5/E1\nM30\n", ":4:", "P305"},
      {"G90 G95 G0 X10\nG1 X20 F0.1\nM30\n", ":2:1: ", "channel.cannot-drive"},
  };
  for (const auto& w : wrong) {
    const std::string path = file("wrong.nc", w.text);
    const Outcome o = shell_.run({"load", path});
    EXPECT_EQ(o.exit, 1) << w.code;
    EXPECT_TRUE(contains(o.err, "was not loaded")) << o.err;
    EXPECT_TRUE(contains(o.err, path + w.place)) << o.err;
    EXPECT_TRUE(contains(o.err, std::string("[") + w.code + "]")) << o.err;
    EXPECT_EQ(shell_.status()["program"], good);
  }
  EXPECT_TRUE(
      contains(shell_.run({"load", file("wrong.nc", wrong[0].text)}, "ru_RU.UTF-8").err, "не загружена"));
}

TEST(ProofOfALathe, knows_the_places_of_its_turret) {
  Shell shell;
  shell.up("lathe");
  const std::string path = (shell.folder() / "wrong.nc").string();
  std::ofstream(path) << "G90\nT9.1 M6\nM30\n";
  const Outcome o = shell.run({"load", path});
  EXPECT_EQ(o.exit, 1);
  EXPECT_NE(o.err.find(path + ":2:1: error: T9"), std::string::npos) << o.err;
}

TEST_F(Proof, warns_of_an_error_that_signals_decide_on) {
  const Outcome o = shell_.run(
      {"load", file("signal.nc", "G90 G0 X10\n(BEQ,SA3,1,A)\nG0 X301\n\"A\" G0 X20\nM30\n"), "--json"});
  EXPECT_EQ(o.exit, 0) << o.err;
  const json findings = json::parse(o.out)["findings"];
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0]["severity"], "warning");
  EXPECT_EQ(findings[0]["line"], 3);
  EXPECT_TRUE(contains(findings[0].dump(), "P701")) << findings;
}

TEST_F(Proof, warns_of_an_error_that_hangs_on_where_the_axes_stand) {
  const std::string steps = file("steps.nc", "G91 G0 X290\nX20\nM30\n");
  const Outcome o = shell_.run({"load", steps});
  EXPECT_EQ(o.exit, 0) << o.err;
  ASSERT_EQ(shell_.run({"mdi", "G90 G0 X-100", "--wait"}).exit, 0);
  ASSERT_EQ(shell_.run({"start", "--wait"}).exit, 0) << "from here it stays inside";
}

TEST_F(Proof, does_not_start_a_program_that_a_new_origin_drives_out_of_the_travel) {
  const std::string program = file("shifted.nc", "G90 G0 X290\nM30\n");
  ASSERT_EQ(shell_.run({"load", program}).exit, 0);
  ASSERT_EQ(shell_.run({"zero", "X", "-20"}).exit, 0);
  const double before = shell_.status()["axes"][0]["command"];
  for (const char* command : {"start", "step"}) {
    const Outcome o = shell_.run({command});
    EXPECT_EQ(o.exit, 1);
    EXPECT_TRUE(contains(o.err, "with the present origins and tools")) << o.err;
    EXPECT_TRUE(contains(o.err, "shifted.nc:1:8: error: X would go to 310")) << o.err;
  }
  EXPECT_EQ(shell_.status()["axes"][0]["command"], before);
  ASSERT_EQ(shell_.run({"mdi", "G0 X0", "--wait"}).exit, 0) << "typed blocks run";
  ASSERT_EQ(shell_.run({"zero", "X", "20"}).exit, 0);
  EXPECT_EQ(shell_.run({"start", "--wait"}).exit, 0) << "the origin is back";
}

}  // namespace
}  // namespace servogate::gateway::testing
