// SPDX-License-Identifier: Apache-2.0
// Part programs are files of the system: what a control does when they are edited, renamed, copied, protected
// or deleted with the system's own tools.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class ProgramFiles : public ::testing::Test {
 protected:
  void begin() {
    shell_.up("mill", {"--virtual", "--speed", "20", "--state", file("state")});
    shell_.ready();
  }
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }
  std::string write(const char* name, const std::string& text) {
    std::ofstream(file(name)) << text;
    return file(name);
  }
  Outcome run(std::vector<std::string> words) {
    words.insert(words.end(), {"--socket", shell_.socket()});
    return shell_.run(words);
  }
  Outcome good(const std::vector<std::string>& words) {
    Outcome o = run(words);
    EXPECT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
    return o;
  }
  std::string canon(const std::string& program) {
    return shell_.run({"canon", Shell::example("mill/machine.toml"), program}).out;
  }
  double x() { return shell_.status()["axes"][0]["command"]; }
  bool ended() {
    return shell_.until([](const json& s) { return s["state"] == "ended"; });
  }

  Shell shell_;
};

TEST_F(ProgramFiles, may_be_edited_renamed_and_deleted_while_their_program_runs) {
  begin();
  const std::string running = write("running.nc", "G1 X40 F600\nG1 X60\nM30\n");
  good({"load", running});
  good({"start"});
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["moving"] == true; }));
  write("running.nc", "G1 X40 F600\nG1 X-99\nM30\n");
  std::filesystem::rename(running, file("renamed.nc"));
  std::filesystem::remove(file("renamed.nc"));
  ASSERT_TRUE(ended());
  EXPECT_NEAR(x(), 60.0, 1e-6) << "the program as it was loaded";
  const Outcome gone = run({"load", running});
  EXPECT_NE(gone.exit, 0);
  EXPECT_TRUE(contains(gone.err, "running.nc")) << gone.err;
  good({"start", "--wait"});
  EXPECT_NEAR(x(), 60.0, 1e-6) << "a load that fails leaves the program that was loaded";
}

TEST_F(ProgramFiles, count_as_they_stand_when_they_are_loaded_and_another_load_takes_their_place) {
  begin();
  good({"load", write("one.nc", "G0 X10\nM30\n")});
  good({"load", write("one.nc", "G0 X20\nM30\n")});
  good({"start", "--wait"});
  EXPECT_NEAR(x(), 20.0, 1e-6);
  const std::string two = write("two.nc", "G0 X30\nM30\n");
  good({"load", two});
  EXPECT_EQ(shell_.status()["processes"][0]["program"], two);
  good({"start", "--wait"});
  EXPECT_NEAR(x(), 30.0, 1e-6);
}

TEST_F(ProgramFiles, copied_elsewhere_and_back_give_the_same_commands_and_changed_ones_others) {
  const std::string program = write("original.nc", "G1 X10 F100\nG1 Y20\nM30\n");
  std::filesystem::create_directory(file("medium"));
  std::filesystem::copy_file(program, file("medium/copy.nc"));
  std::filesystem::copy_file(file("medium/copy.nc"), file("back.nc"));
  EXPECT_EQ(canon(file("medium/copy.nc")), canon(program));
  EXPECT_EQ(canon(file("back.nc")), canon(program));
  EXPECT_NE(canon(program), "");
  EXPECT_NE(canon(write("changed.nc", "G1 X10 F100\nG1 Y21\nM30\n")), canon(program));
}

TEST_F(ProgramFiles, that_may_only_be_read_are_loaded_and_stay_as_they_are) {
  begin();
  const std::string program = write("protected.nc", "G0 X15\nM30\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_read);
  good({"load", program});
  good({"start", "--wait"});
  EXPECT_NEAR(x(), 15.0, 1e-6);
  EXPECT_EQ(shell_.text("protected.nc"), "G0 X15\nM30\n");
}

TEST_F(ProgramFiles, have_tables_beside_them_that_are_written_to_standard_output) {
  begin();
  good({"tool", "set", "3", "length=85", "radius=5", "wear_limit=0.5"});
  const std::string listed = good({"tool", "export", "-"}).out;
  EXPECT_TRUE(contains(listed, "tool,name,radius")) << listed;
  EXPECT_TRUE(contains(listed, "wear_limit_Z")) << listed;
}

TEST_F(ProgramFiles, lie_beside_tables_to_which_a_typed_block_adds) {
  begin();
  good({"tool", "set", "3", "length=85", "radius=5"});
  good({"mdi", "(RQU,3,3,Z0.1,K)", "--wait"});
  good({"mdi", "(RQU,3,3,Z0.2,K-0.04)", "--wait"});
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "length Z 85 mm, radius 5 mm, wear Z 0.3 mm"));
  const json row = json::parse(good({"tool", "list", "--json"}).out)["tools"][0];
  EXPECT_NEAR(row["wear"]["Z"].get<double>(), 0.3, 1e-9);
  EXPECT_NEAR(row["radius_wear"].get<double>(), -0.02, 1e-9);
}

}  // namespace
}  // namespace servogate::gateway::testing
