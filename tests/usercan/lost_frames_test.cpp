// SPDX-License-Identifier: Apache-2.0
// Whatever a command does on a bus: frames that were lost on this computer are trouble of the computer.
#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/comes.hpp"
#include "tests/usercan/rig/mill.hpp"
#include "tests/usercan/rig/own_network.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

class LostFrames : public Udp {
 protected:
  /// No socket of this network with that port has a byte that nobody has read; this one's are read here.
  static bool all_read(image::CanBus& own, std::uint16_t port) {
    for (image::CanFrame frame; own.receive(frame);) continue;
    std::ifstream sockets("/proc/thread-self/net/udp");
    std::string row, number, local, remote, state, queues;
    std::getline(sockets, row);
    while (std::getline(sockets, row)) {
      std::istringstream(row) >> number >> local >> remote >> state >> queues;
      if (std::stoi(local.substr(local.find(':') + 1), nullptr, 16) != port) continue;
      if (std::stoul(queues.substr(queues.find(':') + 1), nullptr, 16) != 0) return false;
    }
    return true;
  }
  /// Stops a living process, fills its socket beyond its room, lets it go on, and ends it.
  static void lose(Process& process, std::uint16_t port, image::CanBus& other) {
    process.signal(SIGSTOP);
    for (int i = 0; i < 20'000; ++i) ASSERT_TRUE(other.send(make(0x77E, {5})));
    process.signal(SIGCONT);
    // What has been lost is known with the next frame that has room.
    ASSERT_TRUE(tests::comes([&] { return all_read(other, port); }));
    ASSERT_TRUE(other.send(make(0x77E, {5})));
    ASSERT_TRUE(tests::comes([&] { return all_read(other, port); }));
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(), 4) << process.said();
    EXPECT_NE(process.said().find("frames were lost on this computer"), std::string::npos) << process.said();
  }
};

TEST_F(LostFrames, of_a_simulated_drive_end_it_with_4) {
  Process drive({"drive", url(43211), "--node", "5"});
  ASSERT_TRUE(drive.says("node 5 on")) << drive.said();
  lose(drive, 43211, *open(43211));
}

TEST_F(LostFrames, of_a_simulated_module_end_it_with_4) {
  Process io({"io", url(43212), "--node", "5"});
  ASSERT_TRUE(io.says("node 5 on")) << io.said();
  lose(io, 43212, *open(43212));
}

TEST_F(LostFrames, of_the_devices_of_a_machine_end_them_with_4) {
  Process sim({"sim", mill(url(43213), patience())});
  ASSERT_TRUE(sim.says("simulated drives on")) << sim.said();
  lose(sim, 43213, *open(43213));
}

TEST_F(LostFrames, of_a_dump_end_it_with_4) {
  Process dump({"dump", url(43214)});
  auto other = open(43214);
  ASSERT_TRUE(tests::comes([&] {
    EXPECT_TRUE(other->send(make(0x77E, {5})));
    return dump.said().find("77E#") != std::string::npos;
  }));
  lose(dump, 43214, *other);
}

TEST_F(LostFrames, of_a_log_that_is_played_end_it_with_4) {
  const std::string log = scratch("log");
  std::ofstream(log) << "(1.0) can0 77E#05\n(1000.0) can0 77E#05\n";
  auto other = open(43215);
  Process play({"play", url(43215), log});
  image::CanFrame first;
  ASSERT_TRUE(wait_for(*other, first));
  lose(play, 43215, *other);
}

TEST_F(LostFrames, of_a_resident_control_end_it_with_4) {
  Process up({"up", mill(url(43216), patience()), "--realtime=best-effort", "--socket", scratch("up.sock")});
  ASSERT_TRUE(up.says("control socket")) << up.said();
  lose(up, 43216, *open(43216));
}

}  // namespace
}  // namespace servogate::usercan
