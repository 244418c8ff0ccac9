// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fstream>
#include <sstream>

#include "drivers/candump/candump_line.hpp"
#include "tests/comes.hpp"
#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

TEST(CandumpLine, is_written_and_read_as_can_utils_has_it) {
  const struct {
    const char* text;
    std::uint32_t id;
    bool extended, remote, fd, error;
    int length, flags = 0;
  } samples[] = {
      {"(1436509052.249713) vcan0 044#2A366C2BBA", 0x44, false, false, false, false, 5},
      {"(0000000000.000001) can0 000#", 0, false, false, false, false, 0},
      {"(1436509053.850870) can0 00012345#0102030405060708", 0x12345, true, false, false, false, 8},
      {"(1436509053.850870) can0 701#R", 0x701, false, true, false, false, 0},
      {"(1436509053.850870) can0 701#R4", 0x701, false, true, false, false, 4},
      {"(1436509053.850870) can0 123##000112233445566778899AABB", 0x123, false, false, true, false, 12},
      {"(1436509053.850870) can0 123##1AABBCC", 0x123, false, false, true, false, 3, image::kBitRateSwitch},
      {"(1436509053.850870) can0 123##2", 0x123, false, false, true, false, 0, image::kErrorStateIndicator},
      {"(1436509053.850870) can0 00000123##3AA", 0x123, true, false, true, false, 1, 3},
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
    EXPECT_EQ(line->frame.fd_flags, s.flags);
    EXPECT_EQ(candump::format(line->frame, line->time, line->bus), s.text);
  }
}

TEST(CandumpLine, what_is_none_is_refused) {
  for (const char* wrong : {"", "vcan0 123#00", "(1.0) vcan0", "(1.0) vcan0 12#00", "(1.0) vcan0 800#00",
                            "(1.0) vcan0 123#0", "(1.0) vcan0 123#001122334455667788", "(x) vcan0 123#00",
                            "(1.0 vcan0 123#00", "(1.0) vcan0 123##", "(1.0) vcan0 123##x00"})
    EXPECT_FALSE(candump::parse(wrong)) << wrong;
}

/// Plays a log again and again until a dump that is being started has come to the bus and heard this of it.
bool played_until(const Process& dump, const std::string& heard, const std::string& url,
                  const std::string& log) {
  return tests::comes([&] {
    Process play({"play", url, log});
    EXPECT_EQ(play.wait(), 0) << play.said();
    return dump.said().find(heard) != std::string::npos;
  });
}

TEST(Dump, what_is_played_onto_a_bus_is_what_is_dumped_from_it) {
  const std::string socket = scratch("bus.sock"), log = scratch("log");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  std::ofstream(log) << "(100.000000) can0 181#DEAD\n(100.010000) can0 00012345#\n(100.010000) can0 701#R1\n"
                        "(100.020000) can0 080#\n";
  Process dump({"dump", url, "--count", "4"});
  ASSERT_TRUE(played_until(dump, "080#", url, log));
  EXPECT_EQ(dump.wait(), 0);
  std::string frames = dump.said();
  for (const char* part : {"can0 181#DEAD\n", "can0 00012345#\n", "can0 701#R1\n", "can0 080#\n"})
    EXPECT_NE(frames.find(part), std::string::npos) << frames;
}

TEST(Dump, a_log_with_a_frame_that_the_bus_cannot_carry_is_not_begun) {
  const std::string socket = scratch("bus.sock"), log = scratch("log");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  std::ofstream(log) << "(1.0) can0 122#01\n(1.0) can0 123##1AABBCC\n(1.1) can0 124#01\n";
  Process dump({"dump", url});
  Process play({"play", url, log});
  EXPECT_EQ(play.wait(), 2);
  EXPECT_NE(play.said().find("log:2: a CAN FD frame"), std::string::npos) << play.said();
  EXPECT_NE(play.said().find("nothing was played"), std::string::npos) << play.said();
  dump.signal(SIGTERM);
  dump.wait();
  EXPECT_EQ(dump.said().find("122#"), std::string::npos) << dump.said();
}

/// Frames of a log without their times and buses.
std::vector<std::string> frames_of(const std::string& log) {
  std::vector<std::string> frames;
  std::istringstream lines(log);
  for (std::string time, bus, frame, rest; lines >> time >> bus >> frame; std::getline(lines, rest))
    if (time.starts_with('(')) frames.push_back(frame);
  return frames;
}

/// What a dump writes while a log is played: all of the log, and nothing else but marks that are played until
/// the dump listens.
std::vector<std::string> dumped_while_playing(const std::string& url, const std::string& log,
                                              std::size_t frames, const std::string& save) {
  const std::string mark = scratch("mark");
  std::ofstream(mark) << "(1.000000) can0 77E#\n";
  Process dump({"dump", url});
  EXPECT_TRUE(played_until(dump, "77E#", url, mark));
  const std::size_t marks = frames_of(dump.said()).size();
  Process play({"play", url, log});
  EXPECT_EQ(play.wait(), 0) << play.said();
  EXPECT_TRUE(tests::comes([&] { return frames_of(dump.said()).size() >= marks + frames; }));
  dump.signal(SIGTERM);
  EXPECT_EQ(dump.wait(), 0);
  std::istringstream lines(dump.said());
  std::ofstream out(save);
  for (std::string line; std::getline(lines, line);)
    if (line.find("77E#") == std::string::npos) out << line << "\n";
  out.close();
  return frames_of(content(save));
}

TEST(Dump, is_understood_by_can_utils_and_what_they_write_is_played) {
  if (shell("command -v log2asc asc2log >/dev/null") != 0)
    GTEST_SKIP() << "no can-utils here; install them so: .ci/packages --tests";
  const std::string socket = scratch("bus.sock"), log = scratch("log"), dumped = scratch("dumped"),
                    asc = scratch("asc"), back = scratch("back");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  const std::vector<std::string> frames = {"181#DEAD", "18FF1234#0102030405060708", "701#R1", "080#",
                                           "000#8002"};
  std::ofstream out(log);
  for (std::size_t i = 0; i < frames.size(); ++i) out << "(100.0" << i << "0000) can0 " << frames[i] << "\n";
  out.close();
  ASSERT_EQ(dumped_while_playing(url, log, frames.size(), dumped), frames);
  // Our dump into the form of another tool, and from there back into a log of can-utils.
  ASSERT_EQ(shell("log2asc -I " + dumped + " -O " + asc + " can0 2>/dev/null"), 0);
  EXPECT_NE(content(asc).find("18FF1234x       Rx   d 8 01 02 03 04 05 06 07 08"), std::string::npos)
      << content(asc);
  ASSERT_EQ(shell("asc2log -I " + asc + " -O " + back + " 2>/dev/null"), 0);
  EXPECT_EQ(frames_of(content(back)), frames) << content(back);
  EXPECT_EQ(dumped_while_playing(url, back, frames.size(), dumped), frames);
}

TEST(Dump, of_a_bus_that_goes_away_says_so_and_ends_as_trouble_of_the_computer) {
  const std::string socket = scratch("bus.sock"), log = scratch("log");
  const std::string url = "socketcand:unix:" + socket + "/can0";
  const Process bus({"can", "bus", "can0", "--listen", "unix:" + socket});
  ASSERT_TRUE(bus.says("can0 at")) << bus.said();
  std::ofstream(log) << "(100.000000) can0 080#\n";
  Process dump({"dump", url});
  ASSERT_TRUE(played_until(dump, "080#", url, log));
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
