// SPDX-License-Identifier: Apache-2.0
// What a machine has learned, in one file and back.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

class Backup : public ::testing::Test {
 protected:
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }
  Outcome run(std::vector<std::string> words) { return shell_.run(words); }
  void learn() {
    shell_.up("mill", {"--virtual", "--speed", "20", "--state", file("state")});
    shell_.ready();
    ASSERT_EQ(run({"origin", "set", "3", "X12.5"}).exit, 0);
    ASSERT_EQ(run({"tool", "set", "7", "length=80", "radius=3"}).exit, 0);
    ASSERT_EQ(run({"down"}).exit, 0);
  }

  Shell shell_;
  const std::string mill_ = Shell::example("mill/machine.toml");
};

TEST_F(Backup, holds_everything_learned_and_brings_it_back) {
  learn();
  const Outcome written = run({"backup", mill_, file("a.backup"), "--state", file("state")});
  ASSERT_EQ(written.exit, 0) << written.err;
  EXPECT_TRUE(contains(written.out, "1 origins, 1 tools")) << written.out;
  std::filesystem::remove_all(file("state"));
  const Outcome restored = run({"restore", mill_, file("a.backup"), "--state", file("state")});
  ASSERT_EQ(restored.exit, 0) << restored.err;
  EXPECT_TRUE(contains(shell_.text("state/origins.toml"), "3 = { X = 12.5 }"));
  EXPECT_TRUE(contains(shell_.text("state/tools.toml"), "number = 7"));
  shell_.up("mill", {"--virtual", "--speed", "20", "--state", file("state")});
  EXPECT_EQ(run({"origin", "list"}).out, "origin 3: X 12.5 mm\n");
}

TEST_F(Backup, keeps_what_stood_there_and_never_meets_a_running_control) {
  learn();
  ASSERT_EQ(run({"backup", mill_, file("a.backup"), "--state", file("state")}).exit, 0);
  ASSERT_EQ(run({"restore", mill_, file("a.backup"), "--state", file("state")}).exit, 0);
  EXPECT_TRUE(contains(shell_.text("state.before-1/origins.toml"), "12.5"));
  shell_.up("mill", {"--virtual", "--speed", "20", "--state", file("state")});
  const Outcome met = run({"restore", mill_, file("a.backup"), "--state", file("state")});
  EXPECT_EQ(met.exit, 4);
  EXPECT_TRUE(contains(met.err, "end the control first")) << met.err;
}

TEST_F(Backup, is_refused_where_it_is_none_damaged_or_of_another_machine) {
  learn();
  ASSERT_EQ(run({"backup", mill_, file("a.backup"), "--state", file("state")}).exit, 0);
  EXPECT_TRUE(
      contains(run({"backup", mill_, file("a.backup"), "--state", file("state")}).err, "is there already"));
  const std::string lathe = Shell::example("lathe/machine.toml");
  const Outcome other = run({"restore", lathe, file("a.backup"), "--state", file("other")});
  EXPECT_EQ(other.exit, 2);
  EXPECT_TRUE(contains(other.err, "is a backup of 'Three-axis mill'")) << other.err;
  std::ofstream(file("none")) << "{}";
  EXPECT_TRUE(contains(run({"restore", mill_, file("none"), "--state", file("state")}).err, "is no backup"));
  std::string text = shell_.text("a.backup");
  text.replace(text.find("offset_counts = "), 16, "offset_counts = 7");
  std::ofstream(file("bad.backup")) << text;
  const Outcome bad = run({"restore", mill_, file("bad.backup"), "--state", file("state")});
  EXPECT_EQ(bad.exit, 2);
  EXPECT_TRUE(contains(bad.err, "checksum")) << bad.err;
  EXPECT_TRUE(contains(shell_.text("state/origins.toml"), "12.5")) << "nothing was changed";
}

}  // namespace
}  // namespace servogate::gateway::testing
