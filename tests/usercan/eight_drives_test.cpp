// SPDX-License-Identifier: Apache-2.0
// Eight simulated drives in one process answer a SYNC every millisecond on one bus.
#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

TEST(EightDrives, in_one_process_answer_every_sync_of_a_millisecond_on_a_bus_of_1_mbit) {
  constexpr int kCycles = 2000;
  const std::string port = "43" + std::to_string(100 + getpid() % 800), log = scratch("bus.log");
  const std::string address = "127.0.0.1:" + port;
  {  // the log is whole when the bus has ended
    const Process bus({"can", "bus", "can0", "--listen", address, "--lockstep", "2", "--log", log});
    ASSERT_TRUE(bus.says("can0 at 1000000 bit/s")) << bus.said();
    const Process drives(
        {"drive", "lockstep:" + address + "/can0", "--node", "1,2,3,4,5,6,7,8", "--device", "servo-cia402"});
    ASSERT_EQ(shell("/usr/bin/python3 " + counterpart("sync_master.py") + " lockstep " + port + " 8 " +
                    std::to_string(kCycles)),
              0)
        << drives.said();
  }
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("check_sync.py") + " " + log + " 8 " +
                  std::to_string(kCycles) + " 1 0.002"),
            0);
}

}  // namespace
}  // namespace servogate::usercan
