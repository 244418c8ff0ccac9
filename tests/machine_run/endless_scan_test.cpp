// SPDX-License-Identifier: Apache-2.0
// A PLC whose scan does not end, on a control in real time: it is stopped, and the control can be ended.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "tests/comes.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

TEST(EndlessScan, of_any_loop_leaves_a_control_that_ends_when_it_is_told) {
  for (const char* loop : {"REPEAT UNTIL X.homed END_REPEAT;", "WHILE NOT X.homed DO ; END_WHILE;",
                           "FOR i := 1 TO 2000000000 BY z DO ; END_FOR;"}) {
    SCOPED_TRACE(loop);
    const Scratch scratch;
    const std::string plc = scratch.write(
        "endless.st", std::string("PROGRAM Main VAR i, z : DINT; END_VAR\n") + loop + "\nEND_PROGRAM\n");
    const std::string machine = changed_mill(scratch, "\"mill.st\"]", "\"" + plc + "\"]");
    const std::string socket = scratch.path("mill.sock");
    Program up(
        {"up", machine, "--realtime=best-effort", "--socket", socket, "--state", scratch.path("state")});
    Ending alarms;
    EXPECT_TRUE(tests::comes([&] {
      if (std::filesystem::exists(socket)) alarms = servogate({"alarms", "--socket", socket});
      return alarms.out.find("5002") != std::string::npos;
    })) << alarms.out
        << alarms.err;
    EXPECT_NE(alarms.out.find("endless.st:2"), std::string::npos) << alarms.out;
    up.signal(SIGTERM);
    EXPECT_EQ(up.wait().code, 0);
  }
}

}  // namespace
}  // namespace servogate::machine_run
