// SPDX-License-Identifier: Apache-2.0
// Places that the control touches by itself: tool setter, edge of the workpiece, how well a probe repeats.
#include <gtest/gtest.h>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

constexpr double kFace = -61.234;  // of the part, as the example's probe meets it

class Touch : public ::testing::Test {
 protected:
  void begin(const std::string& machine = "tapping") {
    shell_.up(machine, {"--virtual", "--speed", "20", "--state", (shell_.folder() / "state").string()});
    shell_.ready();
  }
  Outcome run(const std::vector<std::string>& words) { return shell_.run(words); }
  Outcome good(const std::vector<std::string>& words) {
    Outcome o = run(words);
    EXPECT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
    return o;
  }
  double z() {
    const json status = shell_.status();
    for (const json& a : status["axes"])
      if (a["letter"] == "Z") return a["position"];
    return 1e9;
  }
  Shell shell_;
};

TEST_F(Touch, writes_the_length_of_a_tool_and_says_what_it_was_before) {
  begin();
  good({"mdi", "G0 Z-40", "--wait"});
  good({"tool", "set", "3", "length=5", "name=end mill"});
  const Outcome o = good({"touch", "tool", "3", "Z0", "by=-30", "times=3", "--yes"});
  EXPECT_TRUE(contains(o.out, "before: tool 3: end mill, length Z 5 mm")) << o.out;
  EXPECT_TRUE(contains(o.out, "after: tool 3: end mill, length Z -61.23")) << o.out;
  EXPECT_TRUE(contains(o.out, "3 touches: spread ")) << o.out;
  EXPECT_NEAR(z(), -40.0, 0.01) << "back where it began";
  good({"tool", "undo"});
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "length Z 5 mm"));
}

TEST_F(Touch, writes_an_origin_from_an_edge_behind_the_radius_of_the_ball) {
  begin();
  good({"mdi", "G0 Z-40", "--wait"});
  const json said =
      json::parse(good({"touch", "origin", "1", "Z10", "by=-30", "radius=2", "--yes", "--json"}).out);
  ASSERT_EQ(said["places"].size(), 1u);
  EXPECT_NEAR(said["mean"].get<double>(), kFace, 0.01);
  EXPECT_NEAR(z(), -40.0, 0.01);
  const json tables = json::parse(good({"origin", "list", "--json"}).out);
  EXPECT_NEAR(tables["origins"][0]["values"]["Z"].get<double>(), said["mean"].get<double>() - 2.0 - 10.0,
              2e-3);
}

TEST_F(Touch, only_measures_where_nothing_is_named_to_be_written) {
  begin();
  good({"mdi", "G0 Z-40", "--wait"});
  const Outcome o = good({"touch", "Z", "by=-30", "--yes"});
  EXPECT_TRUE(contains(o.out, "Z is touched at -61.23")) << o.out;
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "is empty"));
}

TEST_F(Touch, that_finds_nothing_is_an_alarm_and_writes_nothing) {
  begin();
  const Outcome o = run({"touch", "tool", "3", "Z0", "by=-5", "--yes"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "nothing is written")) << o.err;
  EXPECT_TRUE(contains(o.out + o.err, "touched nothing")) << o.out << o.err;
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "is empty"));
}

TEST_F(Touch, is_refused_where_it_could_not_be_and_shows_its_plan_where_nobody_can_be_asked) {
  begin();
  const double before = z();
  const struct {
    std::vector<std::string> words;
    const char* said;
  } rows[] = {{{"touch", "tool", "3", "Z0", "by=-5000", "--yes"}, "its travel ends at"},
              {{"touch", "Z", "by=-30", "times=0", "--yes"}, "times is 0"},
              {{"touch", "Z", "by=-30", "slow=500", "--yes"}, "slow is 500"},
              {{"touch", "Z", "by=-1", "--yes"}, "back is 2"},
              {{"touch", "Z", "feed=100", "--yes"}, "'by'"},
              {{"touch", "Z5", "by=-30", "--yes"}, "'Z5'"},
              {{"touch", "tool", "Z0", "by=-30", "--yes"}, "'Z0'"},
              {{"touch", "Z", "by=-30"}, "nothing moves"}};
  for (const auto& row : rows) {
    const Outcome o = run(row.words);
    EXPECT_NE(o.exit, 0) << row.said;
    EXPECT_TRUE(contains(o.err, row.said)) << row.said << "\n" << o.err;
  }
  EXPECT_NEAR(z(), before, 0.01);
}

TEST_F(Touch, needs_a_probe) {
  begin("mill");
  const Outcome o = run({"touch", "Z", "by=-30", "--yes"});
  EXPECT_NE(o.exit, 0);
  EXPECT_TRUE(contains(o.err, "the machine has no probe")) << o.err;
}

}  // namespace
}  // namespace servogate::gateway::testing
