// SPDX-License-Identifier: Apache-2.0
// A control does not start where another computer's control leads the bus, whatever carries its frames.
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "tests/usercan/rig/mill.hpp"
#include "tests/usercan/rig/own_network.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

TEST_F(Udp, a_control_hears_who_leads_the_bus_and_sends_nothing) {
  const auto master = open(29777);
  std::atomic<bool> stop{false};
  std::atomic<int> heard{0};
  std::thread leads([&] {
    for (image::CanFrame frame; !stop; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
      master->send(make(0x080, {}));
      master->send(make(0x205, {0x0F, 0}));
      while (master->receive(frame)) ++heard;
    }
  });
  const std::string program = scratch("short.nc");
  std::ofstream(program) << "N1 G90 G0 X1\nN2 M30\n";
  Process control(
      {"run", mill(url(29777), {{"bit_rate = \"1 Mbit/s\"", "bit_rate = \"1 Mbit/s\"\nsimulated = true"}}),
       program, "--realtime=best-effort", "-q"});
  EXPECT_EQ(control.wait(), 1) << control.said();
  stop = true;
  leads.join();
  for (const char* words : {"another master controls bus udp:", "SYNC (080h) ", "RPDO 1 of node 5 (205h) "})
    EXPECT_NE(control.said().find(words), std::string::npos) << words << "\n" << control.said();
  EXPECT_EQ(heard, 0);
}

}  // namespace
}  // namespace servogate::usercan
