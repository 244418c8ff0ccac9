// SPDX-License-Identifier: Apache-2.0
// What goes wrong with files and folders of a control, as its clients see it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

TEST(Files, a_damaged_state_whose_copy_before_is_in_force_is_an_alarm) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string();
  shell.up("mill", {"--virtual", "--speed", "50", "--state", state});
  shell.ready();
  EXPECT_FALSE(has_alarm(shell.status(), 6006));
  ASSERT_EQ(shell.end(SIGTERM), 0);
  // How many generations a short life leaves behind is a matter of time.
  std::filesystem::copy_file(state + "/homing.toml", state + "/homing.previous.toml",
                             std::filesystem::copy_options::overwrite_existing);
  std::ofstream(state + "/homing.toml", std::ios::app) << "damaged = true\n";
  shell.up("mill", {"--virtual", "--state", state});
  ASSERT_TRUE(shell.until([](const json& s) { return has_alarm(s, 6006); }));
  EXPECT_EQ(alarm_of(shell.status(), 6006)["warning"], true) << "the machine may run all the same";
}

TEST(Files, a_socket_folder_that_others_may_write_into_is_trusted_by_no_client) {
  Shell shell;
  shell.up();
  const std::string folder = (shell.folder() / "servogate").string();
  ASSERT_EQ(::chmod(folder.c_str(), 0777), 0);
  const Outcome o = shell.run({"status"});
  EXPECT_EQ(o.exit, 4);
  EXPECT_TRUE(contains(o.err, "[client.foreign-folder]")) << o.err;
  EXPECT_EQ(shell.run({"status", "--socket", shell.socket()}).exit, 0) << "who names it knows it";
  ASSERT_EQ(::chmod(folder.c_str(), 0700), 0);
  EXPECT_EQ(shell.run({"status"}).exit, 0);
}

}  // namespace
}  // namespace servogate::gateway::testing
