// SPDX-License-Identifier: Apache-2.0
// Programs that are stopped where no alarm stops them, typed blocks, and what keeps the drives off: what is
// said and what to do next.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Stopped : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up();
    shell_.ready();
  }
  void begin(const std::string& blocks) {
    std::ofstream(shell_.folder() / "part.nc") << blocks;
    ASSERT_EQ(shell_.run({"load", (shell_.folder() / "part.nc").string()}).exit, 0);
    ASSERT_EQ(shell_.run({"start"}).exit, 0);
  }
  Shell shell_;
};

TEST_F(Stopped, by_power_off_is_no_alarm_and_names_who_did_it_and_what_to_do_next) {
  begin("N10 G90 G94 G71\nN20 G1 X200 F60\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  const Outcome off = shell_.run({"power", "off"});
  EXPECT_EQ(off.exit, 0) << off.err;
  EXPECT_TRUE(contains(off.out, "the drives are off")) << off.out;
  EXPECT_TRUE(contains(off.out, "stopped in line 2: the command line switched the drives off")) << off.out;
  const json s = shell_.status();
  EXPECT_EQ(s["state"], "stopped");
  EXPECT_EQ(s["stop"]["cause"], "drives_off");
  EXPECT_TRUE(s["alarms"].empty()) << s["alarms"].dump(1);
  const std::string out = shell_.run({"status"}).out;
  EXPECT_TRUE(contains(out, "auto, stopped")) << out;
  EXPECT_TRUE(contains(out, "`servogate power on`, then `servogate start`")) << out;
  EXPECT_TRUE(contains(shell_.run({"status"}, "ru_RU.UTF-8").out, "приводы выключены во время выполнения"));
  ASSERT_EQ(shell_.run({"power", "on"}).exit, 0);
  ASSERT_EQ(shell_.run({"start"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& now) { return now["state"] == "running"; }));
  EXPECT_TRUE(shell_.status()["stop"].is_null());
}

TEST_F(Stopped, by_power_off_while_it_waits_is_the_same) {
  begin("N10 G0 X1\nN20 M0\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "waiting"; }));
  ASSERT_EQ(shell_.run({"power", "off"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped"; })) << shell_.status();
  EXPECT_EQ(shell_.status()["stop"]["cause"], "drives_off");
}

TEST_F(Stopped, by_the_plc_at_rest_names_the_enable_and_where_to_look) {
  std::ifstream in(Shell::example("mill/mill.st"));
  std::string logic((std::istreambuf_iterator<char>(in)), {});
  const std::string before = "X.enable := MC.power_on;", body = "PROGRAM Mill\n";
  ASSERT_NE(logic.find(before), std::string::npos);
  logic.replace(logic.find(before), before.size(), "X.enable := MC.power_on AND NOT away;");
  logic.replace(logic.find(body), body.size(), body + "VAR away : BOOL; END_VAR\n");
  std::ofstream(shell_.folder() / "mill.st") << logic;
  ASSERT_EQ(shell_.run({"plc", "load", "--online", (shell_.folder() / "mill.st").string()}).exit, 0);
  begin("N10 G0 X1\nN20 M0\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "waiting"; }));
  ASSERT_EQ(shell_.run({"plc", "force", "Mill.away=TRUE", "--stay"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped"; })) << shell_.status();
  const json stop = shell_.status()["stop"];
  EXPECT_EQ(stop["cause"], "enable_withdrawn");
  EXPECT_TRUE(contains(stop["text"], "X.enable")) << stop;
  EXPECT_TRUE(contains(stop["remedy"], "mill.st")) << stop;
}

TEST_F(Stopped, blocks_that_were_typed_are_shown_as_that_and_not_as_a_subprogram) {
  std::ofstream(shell_.folder() / "part.nc") << "N10 G0 X1\nN20 M2\n";
  ASSERT_EQ(shell_.run({"load", (shell_.folder() / "part.nc").string()}).exit, 0);
  ASSERT_EQ(shell_.run({"mdi", "G1 X200 F60"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  const std::string out = shell_.run({"status"}).out;
  EXPECT_TRUE(contains(out, "typed block: G1 X200 F60\n")) << out;
  EXPECT_TRUE(contains(out, "part.nc: 2 blocks\n")) << out;
  EXPECT_FALSE(contains(out, "subprogram")) << out;
  EXPECT_TRUE(contains(shell_.run({"status"}, "ru_RU.UTF-8").out, "введённый кадр: G1 X200 F60"));
  EXPECT_EQ(shell_.status()["block"], "G1 X200 F60");
  ASSERT_EQ(shell_.run({"reset"}).exit, 0);
  EXPECT_TRUE(shell_.until([](const json& s) { return s["block"].is_null(); }));
}

TEST_F(Stopped, warnings_of_a_block_go_when_the_next_one_starts) {
  ASSERT_EQ(shell_.run({"mdi", "S7000", "--wait"}).exit, 0);
  ASSERT_EQ(shell_.status()["alarms"][0]["number"], 4012);
  ASSERT_EQ(shell_.run({"mdi", "G0 X1", "--wait"}).exit, 0);
  EXPECT_TRUE(shell_.status()["alarms"].empty()) << shell_.status()["alarms"].dump(1);
}

TEST_F(Stopped, status_is_all_in_the_users_language) {
  begin("N10 (DIS,\"A\")\nN20 G1 X200 F60\nN30 M2\n");
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  const std::string out = shell_.run({"status"}, "ru_RU.UTF-8").out;
  for (const char* part :
       {"авто, выполняется", "строка 2 из 3", "подача ", "мм/мин", "инструмент",
        "оси: в координатах программы, в координатах станка, остаток пути:", "привод работает", "выведена в ноль", "движется", "шпиндель 0 об/мин"})
    EXPECT_TRUE(contains(out, part)) << part << ": " << out;
  for (const char* english :
       {"auto", "running", "feed", "homed", "moving", "spindle", "operation_enabled", "rpm"})
    EXPECT_FALSE(contains(out, english)) << english << ": " << out;
}

TEST(Start, that_is_refused_because_the_drives_are_off_names_each_missing_condition) {
  Shell shell;
  shell.up();
  const Outcome off = shell.run({"home"});
  EXPECT_EQ(off.exit, 1);
  EXPECT_TRUE(contains(off.err, "the drives are not switched on\n    `servogate power on`.")) << off.err;
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "off"}).exit, 0);
  for (const char* command : {"home", "power"}) {
    const Outcome o = command == std::string("home") ? shell.run({"home"}) : shell.run({"power", "on"});
    EXPECT_EQ(o.exit, 1) << command;
    EXPECT_TRUE(contains(o.err, "the emergency-stop chain is open: estop_chain_ok (SA17.BL) is FALSE"))
        << o.err;
    EXPECT_TRUE(contains(o.err, "`servogate input estop_chain_ok on`")) << o.err;
  }
  const std::string russian = shell.run({"status"}, "ru_RU.UTF-8").out;
  EXPECT_TRUE(contains(russian, "цепь аварийного останова разомкнута: estop_chain_ok")) << russian;
  EXPECT_EQ(shell.status()["missing"][0]["reason"], "emergency_stop");
}

TEST_F(Stopped, power_off_returns_when_nothing_is_driven_any_more) {
  ASSERT_EQ(shell_.run({"jog", "X", "+100mm", "--no-wait"}).exit, 0);
  EXPECT_EQ(shell_.run({"power", "off"}).exit, 0) << "in the middle of it, or behind it";
  const json s = shell_.status();
  for (const json& a : s["axes"]) {
    EXPECT_FALSE(a["moving"].get<bool>()) << a;
    EXPECT_NE(a["drive"], "operation_enabled") << a;
  }
}

}  // namespace
}  // namespace servogate::gateway::testing
