// SPDX-License-Identifier: Apache-2.0
// MDI and a running program say what the machine does otherwise than they ask.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

TEST(Capability, is_said_in_the_answer_to_mdi_and_as_a_warning_that_ends_nothing) {
  Shell shell;
  shell.up();
  shell.ready();
  const Outcome told = shell.run({"mdi", "S7000"});
  EXPECT_EQ(told.exit, 0) << told.err;
  EXPECT_NE(told.out.find("MDI:1:1: warning: S7000 is above the 6000 rpm of the spindle"), std::string::npos)
      << told.out;
  ASSERT_TRUE(shell.until([](const json& s) { return s["state"] == "ended"; }));
  const json alarms = shell.status()["alarms"];
  ASSERT_EQ(alarms.size(), 1u) << alarms.dump(1);
  EXPECT_EQ(alarms[0]["number"], 4012);
  EXPECT_TRUE(alarms[0]["warning"].get<bool>());
  EXPECT_NE(alarms[0]["text"].get<std::string>().find("S7000 is above"), std::string::npos) << alarms.dump(1);
  EXPECT_EQ(shell.run({"mdi", "S7000", "--wait"}).exit, 0) << "a warning is no failure";
  EXPECT_EQ(shell.run({"reset"}).exit, 0);
  EXPECT_TRUE(shell.status()["alarms"].empty());
  const json refused = shell.ask({{"cmd", "mdi"}, {"block", "G96 S100"}});
  EXPECT_FALSE(refused["ok"].get<bool>());
  EXPECT_NE(refused["text"].get<std::string>().find("P810"), std::string::npos) << refused.dump(1);
}

TEST(Capability, of_a_loaded_program_is_said_while_it_runs) {
  Shell shell;
  shell.up();
  shell.ready();
  const std::string program = (shell.folder() / "fast.nc").string();
  std::ofstream(program) << "N10 G1 X20 F40000\nN20 X30\nM30\n";
  ASSERT_EQ(shell.run({"load", program}).exit, 0);
  EXPECT_EQ(shell.run({"start", "--wait"}).exit, 0);
  const json alarms = shell.status()["alarms"];
  ASSERT_EQ(alarms.size(), 1u) << alarms.dump(1);
  EXPECT_EQ(alarms[0]["line"], 1);
  EXPECT_NE(alarms[0]["text"].get<std::string>().find("fast.nc:1:12: warning: F40000"), std::string::npos)
      << alarms.dump(1);
}

}  // namespace
}  // namespace servogate::gateway::testing
