// SPDX-License-Identifier: Apache-2.0
// Faults on demand in a run: `servogate run --fault`.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class RunFaults : public ::testing::Test {
 protected:
  Outcome run(std::vector<std::string> more) {
    std::vector<std::string> words{"run",
                                   Shell::example("mill/machine.toml"),
                                   Shell::example("mill/bracket.nc"),
                                   "--virtual",
                                   "-q",
                                   "--report",
                                   file("r.json")};
    words.insert(words.end(), more.begin(), more.end());
    return shell_.run(words);
  }
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }

  Shell shell_;
};

TEST_F(RunFaults, lose_a_drive_in_the_cut_at_the_time_that_was_asked_for) {
  const Outcome o = run({"--fault", "kill node=2 at=30"});
  EXPECT_EQ(o.exit, 1) << o.out << o.err;
  const json report = json::parse(shell_.text("r.json"));
  ASSERT_FALSE(report["alarms"].empty());
  EXPECT_NEAR(report["alarms"][0]["t"].get<double>(), 30.0, 0.1);
}

TEST_F(RunFaults, are_read_from_a_script_and_end_again) {
  std::ofstream(file("faults"))
      << "# a drive that says nothing for three cycles less than it may\n20 pdo_dropped node=1 for=2ms\n";
  EXPECT_EQ(run({"--script", file("faults")}).exit, 0);
}

TEST_F(RunFaults, that_cannot_happen_are_refused_before_anything_moves) {
  const struct {
    const char *fault, *said;
  } rows[] = {{"kill node=99 at=1", "no bus of the machine file has a node 99"},
              {"kill at=1", "name what it happens to"},
              {"explode node=2", "explode"},
              {"bounce device=can.x at=1", "bounce"},
              {"load 5 node=1", "only faults and `clear` are possible here"}};
  for (const auto& row : rows) {
    const Outcome o = run({"--fault", row.fault});
    EXPECT_EQ(o.exit, 2) << row.fault << o.out << o.err;
    EXPECT_TRUE(contains(o.err, row.said)) << row.fault << "\n" << o.err;
  }
}

}  // namespace
}  // namespace servogate::gateway::testing
