// SPDX-License-Identifier: Apache-2.0
// Forcing what guards motion or energy on a running control: at standstill only, with a warning, and what a
// client leaves behind when it is gone.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

constexpr int kGuardForced = 6005;

class ForcedGuard : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up();
    shell_.ready();
  }
  void turn_the_spindle() {
    ASSERT_EQ(shell_.run({"mdi", "S3000 M3", "--wait"}).exit, 0);
    ASSERT_TRUE(shell_.plc_becomes("S.at_speed", true));
  }
  void stop_the_spindle() {
    ASSERT_EQ(shell_.run({"reset"}).exit, 0);
    ASSERT_TRUE(shell_.plc_becomes("S.zero_speed", true));
  }
  Outcome force(const std::string& setting) { return shell_.run({"plc", "force", setting, "--stay"}); }
  bool free_again() {
    return shell_.until([](const json& s) { return s["forced"].empty() && !has_alarm(s, kGuardForced); });
  }
  Shell shell_;
};

TEST_F(ForcedGuard, is_refused_while_the_spindle_turns_whatever_the_value_and_names_what_stops_it) {
  turn_the_spindle();
  for (const char* setting : {"S.enable=TRUE", "S.enable=FALSE", "NC.stop=FALSE", "NC.feed_enable=TRUE",
                              "X.enable=TRUE", "MC.power_on=TRUE"}) {
    const Outcome o = force(setting);
    EXPECT_EQ(o.exit, 1) << setting;
    EXPECT_TRUE(contains(o.err, "[gate.guard_spindle]") && contains(o.err, "`servogate reset`")) << o.err;
  }
  EXPECT_TRUE(shell_.status()["forced"].empty());
  ASSERT_EQ(shell_.run({"input", "door_closed", "off"}).exit, 0);
  EXPECT_TRUE(shell_.plc_becomes("S.zero_speed", true)) << "the open door stops the spindle";
}

TEST_F(ForcedGuard, of_a_spindle_at_rest_is_warned_of_and_let_go_only_at_rest) {
  ASSERT_EQ(force("S.enable=TRUE").exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return has_alarm(s, kGuardForced); }));
  turn_the_spindle();
  for (const auto& arguments :
       {std::vector<std::string>{"plc", "force", "--release", "S.enable"},
        std::vector<std::string>{"plc", "force", "--release"}}) {
    const Outcome o = shell_.run(arguments);
    EXPECT_EQ(o.exit, 1);
    EXPECT_TRUE(contains(o.err, "S.enable stays forced: ") && contains(o.err, "`servogate reset`")) << o.err;
  }
  EXPECT_TRUE(has_alarm(shell_.status(), kGuardForced));
  stop_the_spindle();
  EXPECT_EQ(shell_.run({"plc", "force", "--release", "S.enable"}).exit, 0);
  EXPECT_TRUE(free_again());
}

TEST_F(ForcedGuard, whose_client_goes_in_motion_is_let_go_once_the_machine_stands) {
  const pid_t client = shell_.spawn({"plc", "force", "S.enable=TRUE", "lamp_green=TRUE"}, "force");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["forced"].size() == 2; }));
  turn_the_spindle();
  kill(client, SIGKILL);
  ending_of(client);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["forced"].size() == 1; })) << "the lamp is free";
  EXPECT_EQ(shell_.status()["forced"][0]["name"], "S.enable");
  EXPECT_TRUE(has_alarm(shell_.status(), kGuardForced)) << "as long as it lasts";
  stop_the_spindle();
  EXPECT_TRUE(free_again());
}

}  // namespace
}  // namespace servogate::gateway::testing
