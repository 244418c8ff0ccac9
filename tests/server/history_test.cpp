// SPDX-License-Identifier: Apache-2.0
// What a control's history says after the fact: `servogate alarms --history`, events.jsonl.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// The texts of a control's history, oldest first.
std::vector<std::string> texts(Shell& shell) {
  std::vector<std::string> all;
  const json answer = shell.ask({{"cmd", "history"}, {"count", 1000}});
  for (const json& e : answer["events"]) all.push_back(e["text"]);
  return all;
}

/// Where the text that holds `part` stands, from `from` on; -1: nowhere.
int place_of(const std::vector<std::string>& all, const std::string& part, int from = 0) {
  const auto found =
      std::find_if(all.begin() + from, all.end(), [&](const std::string& t) { return contains(t, part); });
  return found == all.end() ? -1 : static_cast<int>(found - all.begin());
}

bool comes(Shell& shell, const std::string& part) {
  return shell.until([&](const json&) { return place_of(texts(shell), part) >= 0; });
}

TEST(HistoryOfAControl, tells_an_emergency_stop_in_its_order_after_everything_is_cleared) {
  Shell shell;
  shell.up();
  shell.ready();
  ASSERT_TRUE(comes(shell, "the drives are on"));
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "off"}).exit, 0);
  ASSERT_TRUE(comes(shell, "the drives are off"));
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "on"}).exit, 0);
  ASSERT_EQ(shell.run({"reset"}).exit, 0);
  ASSERT_TRUE(comes(shell, "no longer: "));
  ASSERT_EQ(shell.run({"alarms"}).out, "no alarm is active\n");
  const std::vector<std::string> all = texts(shell);
  const int up = place_of(all, "is up"), asked = place_of(all, "command line: drives on");
  const int on = place_of(all, "the drives are on"), alarm = place_of(all, "alarm ");
  const int off = place_of(all, "the drives are off"), reset = place_of(all, "command line: reset");
  EXPECT_LE(0, up);
  EXPECT_LT(up, asked);
  EXPECT_LT(asked, on);
  EXPECT_LT(on, alarm);
  EXPECT_LT(on, off);
  EXPECT_LT(alarm, reset);
  EXPECT_LT(reset, place_of(all, "no longer: "));
  const Outcome told = shell.run({"alarms", "--history"});
  EXPECT_TRUE(contains(told.out, "Z  alarm ")) << told.out;
  EXPECT_TRUE(contains(shell.run({"alarms", "--history"}, "ru_RU.UTF-8").out, "приводы выключены"));
  const std::string one = shell.run({"alarms", "--history", "--last", "1"}).out;
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 1) << one;
}

TEST(HistoryOfAControl, names_programs_who_stopped_them_and_what_was_refused) {
  Shell shell;
  shell.up();
  EXPECT_EQ(shell.run({"home"}).exit, 1);
  ASSERT_TRUE(comes(shell, "command line: home all axes: refused: "));
  shell.ready();
  std::ofstream(shell.folder() / "part.nc") << "N10 G90 G94 G71\nN20 G1 X200 F60\nN30 M2\n";
  ASSERT_EQ(shell.run({"load", (shell.folder() / "part.nc").string()}).exit, 0);
  ASSERT_EQ(shell.run({"start"}).exit, 0);
  ASSERT_TRUE(comes(shell, "part.nc was started"));
  ASSERT_TRUE(shell.until([](const json& s) { return s["feed_mm_min"] > 10.0; }));
  ASSERT_EQ(shell.run({"hold"}).exit, 0);
  ASSERT_TRUE(comes(shell, "held in line 2"));
  ASSERT_EQ(shell.run({"resume"}).exit, 0);
  ASSERT_TRUE(comes(shell, "goes on in line 2"));
  ASSERT_EQ(shell.run({"power", "off"}).exit, 0);
  EXPECT_TRUE(comes(shell, "stopped in line 2: the command line switched the drives off"));
}

TEST(HistoryOfAControl, outlives_it_in_the_state_directory) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string();
  shell.up("mill", {"--virtual", "--speed", "20", "--state", state});
  EXPECT_EQ(shell.end(SIGTERM), 0);
  shell.up("mill", {"--virtual", "--speed", "20", "--state", state});
  const std::vector<std::string> all = texts(shell);
  const int ended = place_of(all, "has ended");
  EXPECT_LT(place_of(all, "is up"), ended);
  EXPECT_LT(ended, place_of(all, "is up", std::max(ended, 0)));
  EXPECT_TRUE(std::filesystem::exists(state + "/events.jsonl"));
}

}  // namespace
}  // namespace servogate::gateway::testing
