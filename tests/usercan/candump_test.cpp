// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "drivers/candump/candump_line.hpp"
#include "tests/usercan/process.hpp"
#include "tests/usercan/running_server.hpp"

namespace servogate::usercan {
namespace {

TEST(CandumpLine, is_written_and_read_as_can_utils_has_it) {
  const struct {
    const char* text;
    std::uint32_t id;
    bool extended, remote, fd, error;
    int length;
  } samples[] = {
      {"(1436509052.249713) vcan0 044#2A366C2BBA", 0x44, false, false, false, false, 5},
      {"(0000000000.000001) can0 000#", 0, false, false, false, false, 0},
      {"(1436509053.850870) can0 00012345#0102030405060708", 0x12345, true, false, false, false, 8},
      {"(1436509053.850870) can0 701#R", 0x701, false, true, false, false, 0},
      {"(1436509053.850870) can0 701#R4", 0x701, false, true, false, false, 4},
      {"(1436509053.850870) can0 123##000112233445566778899AABB", 0x123, false, false, true, false, 12},
      {"(1436509053.850870) can0 20000004#0008000000000000", 0x4, false, false, false, true, 8},
  };
  for (const auto& s : samples) {
    const auto line = candump::parse(s.text);
    ASSERT_TRUE(line) << s.text;
    EXPECT_EQ(line->frame.id, s.id);
    EXPECT_EQ(line->frame.extended, s.extended);
    EXPECT_EQ(line->frame.remote, s.remote);
    EXPECT_EQ(line->frame.fd, s.fd);
    EXPECT_EQ(line->frame.error, s.error);
    EXPECT_EQ(line->frame.length, s.length);
    EXPECT_EQ(candump::format(line->frame, line->time, line->bus), s.text);
  }
}

TEST(CandumpLine, what_is_none_is_refused) {
  for (const char* wrong :
       {"", "vcan0 123#00", "(1.0) vcan0", "(1.0) vcan0 12#00", "(1.0) vcan0 800#00", "(1.0) vcan0 123#0",
        "(1.0) vcan0 123#001122334455667788", "(x) vcan0 123#00", "(1.0 vcan0 123#00", "(1.0) vcan0 123##"})
    EXPECT_FALSE(candump::parse(wrong)) << wrong;
}

TEST(Dump, what_is_played_onto_a_bus_is_what_is_dumped_from_it) {
  const std::string socket = scratch("bus.sock"), log = scratch("log");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  std::ofstream(log) << "(100.000000) can0 181#DEAD\n(100.010000) can0 00012345#\n(100.010000) can0 701#R1\n"
                        "(100.020000) can0 080#\n";
  Process dump({"dump", url, "--count", "4"});
  // Played until the dump has come to the bus.
  for (int i = 0; i < 100 && dump.said().find("080#") == std::string::npos; ++i) {
    Process play({"play", url, log});
    ASSERT_EQ(play.wait(), 0) << play.said();
  }
  EXPECT_EQ(dump.wait(), 0);
  std::string frames = dump.said();
  for (const char* part : {"can0 181#DEAD\n", "can0 00012345#\n", "can0 701#R1\n", "can0 080#\n"})
    EXPECT_NE(frames.find(part), std::string::npos) << frames;
}

TEST(Dump, of_a_bus_that_goes_away_says_so_and_ends_as_trouble_of_the_computer) {
  const std::string socket = scratch("bus.sock"), log = scratch("log");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  std::ofstream(log) << "(100.000000) can0 080#\n";
  Process dump({"dump", url});
  for (int i = 0; i < 100 && dump.said().find("080#") == std::string::npos; ++i) {
    Process play({"play", url, log});
    ASSERT_EQ(play.wait(), 0) << play.said();
  }
  bus.signal(SIGTERM);
  EXPECT_EQ(dump.wait(), 4);
  EXPECT_NE(dump.said().find("gone down"), std::string::npos) << dump.said();
}

TEST(Dump, a_log_that_is_none_is_named_with_its_line) {
  const std::string log = scratch("log");
  std::ofstream(log) << "(100.000000) can0 181#DEAD\nnonsense\n";
  Process play({"play", "socketcand:unix:/nowhere/can0", log});
  EXPECT_EQ(play.wait(), 2);
  EXPECT_NE(play.said().find(log + ":2:"), std::string::npos) << play.said();
}

}  // namespace
}  // namespace servogate::usercan
