// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/places/places.hpp"
#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

TEST(Installed, it_runs_from_its_own_folder_and_finds_the_device_files_beside_it) {
  const Desk desk;
  const std::string install =
      tests::cmake() + " --install " + tests::binary_dir() + " --prefix \"$PWD/there\" > install.log 2>&1";
  ASSERT_EQ(desk.line(install).code, 0) << desk.text("install.log");
  EXPECT_EQ(desk.line("there/bin/servogate check there/share/servogate/examples/mill/machine.toml").code, 0);
  // A device file that only the installed folder has.
  ASSERT_EQ(
      desk.line("cd there/share/servogate && cp devices/servo-cia402.toml devices/only-here.toml && "
                "sed 's/\"servo-cia402\"/\"only-here\"/' examples/mill/machine.toml > ../../../m.toml && "
                "cp examples/mill/mill.st ../../..")
          .code,
      0);
  const Ended e = desk.line("there/bin/servogate check m.toml");
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(desk.line("$SG check m.toml").code, 1) << "found elsewhere";
}

TEST(RealTime, that_is_refused_names_the_program_itself_in_the_command_that_grants_it) {
  const Desk desk;
  // Also where the tests run as root, who has the rights otherwise.
  const Ended e = desk.line(
      "mkdir 'a b'; cp $SG 'a b/servogate'; ulimit -r 0; "
      "if [ $(id -u) = 0 ]; then without='setpriv --bounding-set=-sys_nice,-ipc_lock'; fi; "
      "$without 'a b/servogate' run $MILL --realtime -q");
  EXPECT_EQ(e.code, 4) << e.err;
  EXPECT_TRUE(e.err_has("sudo setcap cap_sys_nice,cap_ipc_lock=ep '" + desk.path("a b/servogate'"))) << e.err;
}

}  // namespace
}  // namespace servogate::shell
