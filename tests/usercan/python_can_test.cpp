// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/message_pack.hpp"
#include "drivers/usercan/udp_bus.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

bool python_can() { return shell("/usr/bin/python3 -c 'import can, msgpack' 2>/dev/null") == 0; }

TEST(PythonCan, as_a_master_brings_the_simulated_drive_through_every_state_and_mode_over_socketcand) {
  if (!python_can()) GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  RunningServer server;
  const LivingDrive drive(server.join(), 5);
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("drive_master.py") +
                  " 5 socketcand can0 host=127.0.0.1 port=" + std::to_string(server.address().port)),
            0);
}

TEST(PythonCan, as_a_master_that_does_everything_wrong_gets_the_answers_of_the_standard) {
  if (!python_can()) GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  RunningServer server;
  const LivingDrive drive(server.join(), 5);
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("drive_trials.py") +
                  " 5 socketcand can0 host=127.0.0.1 port=" + std::to_string(server.address().port)),
            0);
}

TEST(PythonCan, hears_every_frame_of_a_busy_bus_although_reads_cut_elements_in_two) {
  if (!python_can()) GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  RunningServer server;
  auto bus = server.join();
  const std::string file = scratch("heard");
  std::atomic<bool> stop{false};
  // A bus that is never quiet while python-can opens it.
  std::thread sender([&] {
    for (std::uint32_t i = 0; !stop; ++i) {
      while (!stop && !bus->send(make(0x100 + i % 256,
                                      {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)})))
        usleep(500);
      if (i % 16 == 0) usleep(2000);
    }
  });
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("count_frames.py") + " " +
                  std::to_string(server.address().port) + " 2000"),
            0);
  stop = true;
  sender.join();
}

}  // namespace
}  // namespace servogate::usercan
