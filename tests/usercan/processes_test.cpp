// SPDX-License-Identifier: Apache-2.0
// The servogate program with itself: a bus, drives and the mill, each a process of its own.
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/comes.hpp"
#include "tests/usercan/rig/mill.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

std::string program() {
  const std::string file = scratch("square.nc");
  std::ofstream(file) << "N1 G90 G0 X10 Y0 Z0\nN2 G1 X10 Y10 F3000\nN3 G1 X0 Y0 Z-5\nN4 M30\n";
  return file;
}

/// What a bus server says first: the address, with the port that the system chose.
std::string address_of(const Process& bus) {
  const std::string said = bus.said();
  return said.substr(0, said.find(": can0"));
}

/// Where a bus server may listen: neither needs rights.
class Wires : public ::testing::TestWithParam<const char*> {};

TEST_P(Wires, the_mill_runs_in_real_time_on_a_bus_between_processes_without_rights) {
  const std::string wire = GetParam();
  const std::string log = scratch("bus.log");
  const Process bus({"can", "bus", "can0", "--listen", wire == "unix" ? "unix:" + scratch("bus.sock") : wire,
                     "--log", log});
  ASSERT_TRUE(bus.says("can0 at 1000000 bit/s")) << bus.said();
  const std::string machine = mill("socketcand:" + address_of(bus) + "/can0", patience());
  const auto living = mill_drives(machine);
  for (const char* time : {"the first", "the second"}) {
    Process run({"run", machine, program(), "--realtime=best-effort", "-q"});
    EXPECT_EQ(run.wait(), 0) << run.said();
    EXPECT_EQ(run.said().find("alarm"), std::string::npos) << time << " run: " << run.said();
    // Drives that are told so do not miss their control, for any time; this is longer than the three seconds after
    // which they would say that it is missing.
    std::this_thread::sleep_for(std::chrono::milliseconds(3500));
  }
  const std::string wire_log = content(log);
  EXPECT_EQ(wire_log.find("3081110000000000"), std::string::npos) << "8130h: a heartbeat was missed";
}

INSTANTIATE_TEST_SUITE_P(Processes, Wires, ::testing::Values("unix", "127.0.0.1:0"),
                         [](const auto& wire) { return std::string(wire.param) == "unix" ? "unix" : "tcp"; });

TEST(Processes, drives_that_may_be_real_stay_off_until_somebody_presses_the_button) {
  const std::string socket = scratch("bus.sock"), trace = scratch("trace.csv"), log = scratch("bus.log");
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket, "--log", log});
  ASSERT_TRUE(bus.says("can0 at 1000000 bit/s")) << bus.said();
  const std::string machine = mill("socketcand:unix:" + socket + "/can0",
                                   {{"[safety]", "[safety]\nmock_inputs_guard_real_drives = true"},
                                    {"cycle_time = \"1 ms\"", "cycle_time = \"4 ms\""}});
  // Nobody in the control simulates drives that may be real.
  std::string text = content(machine);
  text.erase(text.find("[[simulation.drive]]"));
  std::ofstream(machine) << text;
  const Process living({"drive", "socketcand:unix:" + socket + "/can0", "--node", "1,2,3,4"});
  Process run({"run", machine, program(), "--realtime=best-effort", "-q", "--trace", trace});
  ASSERT_TRUE(run.says("the start button 'cycle_start' switches the drives on")) << run.said();
  // Until the drives have been addressed for a while; they stay off for any time.
  ASSERT_TRUE(tests::comes(
      [&] {
        const std::string heard = content(log);
        std::size_t at = 0;
        int seen = 0;
        while ((at = heard.find(" 201#", at)) != std::string::npos) ++seen, ++at;
        return seen > 500;
      },
      std::chrono::milliseconds(50)));
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 3) << run.said();
  // Controlwords of the RPDOs: none with Enable operation (bit 3).
  std::istringstream lines(content(log));
  int seen = 0;
  for (std::string line; std::getline(lines, line);)
    for (const char* id : {" 201#", " 202#", " 203#"})
      if (const std::size_t at = line.find(id); at != std::string::npos) {
        ++seen;
        EXPECT_EQ(std::stoi(line.substr(at + 5, 2), nullptr, 16) & 0x08, 0) << line;
      }
  EXPECT_GT(seen, 0) << "the drives were addressed";
}

TEST(Processes, the_mill_with_drives_in_lockstep_repeats_to_the_byte) {
  std::vector<std::string> traces;
  for (int i = 0; i < 2; ++i) {
    const std::string socket = scratch("bus.sock"), trace = scratch("trace.csv"), log = scratch("bus.log");
    const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket, "--lockstep", "4", "--log", log});
    ASSERT_TRUE(bus.says("can0 at")) << bus.said();
    const std::string machine =
        mill("lockstep:unix:" + socket + "/can0", {{"cycle_time = \"1 ms\"", "cycle_time = \"4 ms\""}});
    const auto living = mill_drives(machine);
    Process run({"run", machine, program(), "--virtual", "-q", "--trace", trace});
    ASSERT_EQ(run.wait(), 0) << run.said();
    traces.push_back(content(trace));
    EXPECT_NE(content(log).find(") can0 080#\n"), std::string::npos);
  }
  EXPECT_GT(traces[0].size(), 10'000u);
  EXPECT_TRUE(traces[0] == traces[1]) << "two runs differ";
}

TEST(Processes, a_bus_that_cannot_be_opened_is_infrastructure_and_says_what_to_do) {
  const std::string machine =
      mill("socketcand:127.0.0.1:1/can0",
           {{"bit_rate = \"1 Mbit/s\"", "bit_rate = \"1 Mbit/s\"\nsimulated = true"}});
  Process run({"run", machine, program(), "--realtime=best-effort"});
  EXPECT_EQ(run.wait(), 4);
  EXPECT_NE(run.said().find("servogate can bus can0 --listen 127.0.0.1:1"), std::string::npos) << run.said();
}

TEST(Processes, a_machine_is_not_believed_to_be_simulated_when_a_real_bus_may_be_behind_the_url) {
  // As socketcand itself answers: it knows no remote frames, and serves real interfaces.
  Address address;
  address.host = "127.0.0.1";
  drivers::Notice why;
  const int listener = listen_on(address, why);
  ASSERT_GE(listener, 0);
  std::atomic<bool> stop{false};
  std::thread socketcand([&] {
    while (!stop) {
      const int s = accept(listener, nullptr, nullptr);
      if (s < 0) {
        usleep(10'000);
        continue;
      }
      char heard[256];
      for (const char* answer : {"< hi >", "< ok >", "< ok >", "< error unknown command >"}) {
        if (send(s, answer, std::string_view(answer).size(), MSG_NOSIGNAL) < 0 ||
            recv(s, heard, sizeof heard, 0) <= 0)
          break;
      }
      close(s);
    }
  });
  Process run({"run",
               mill("socketcand:" + address.str() + "/can0",
                    {{"bit_rate = \"1 Mbit/s\"", "bit_rate = \"1 Mbit/s\"\nsimulated = true"}}),
               program(), "--realtime=best-effort"});
  EXPECT_EQ(run.wait(), 2);
  EXPECT_NE(run.said().find("a real one may be behind"), std::string::npos) << run.said();
  stop = true;
  socketcand.join();
  close(listener);
}

TEST(Processes, a_drive_ends_when_its_bus_is_gone_and_says_so) {
  const std::string socket = scratch("bus.sock");
  auto bus =
      std::make_unique<Process>(std::vector<std::string>{"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus->says("can0 at")) << bus->said();
  Process drive(
      {"drive", "socketcand:unix:" + socket + "/can0", "--node", "1,2", "--device", "servo-cia402"});
  ASSERT_TRUE(drive.says("node 2 on"));
  bus.reset();
  EXPECT_EQ(drive.wait(), 4);
  EXPECT_NE(drive.said().find("is gone"), std::string::npos);
}

}  // namespace
}  // namespace servogate::usercan
