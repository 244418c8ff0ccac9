// SPDX-License-Identifier: Apache-2.0
// `run --can-log`: what the simulated buses of a machine carry, as files.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "drivers/candump/candump_line.hpp"
#include "tests/places/places.hpp"
#include "tests/usercan/rig/mill.hpp"
#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

std::string square() {
  const std::string file = scratch("square.nc");
  std::ofstream(file) << "N1 G90 G0 X10 Y0 Z0\nN2 G1 X10 Y10 F3000\nN3 M30\n";
  return file;
}

const std::string kMachine = tests::source_dir() + "/examples/mill/machine.toml";

std::vector<candump::Line> log_of(const std::string& machine, const std::string& folder, int code = 0) {
  Process run({"run", machine, square(), "--virtual", "-q", "--can-log", folder});
  EXPECT_EQ(run.wait(), code) << run.said();
  std::vector<candump::Line> lines;
  std::istringstream text(content(folder + "/can.log"));
  for (std::string line; std::getline(text, line);) {
    const auto read = candump::parse(line);
    EXPECT_TRUE(read) << line;
    if (read) lines.push_back(*read);
  }
  return lines;
}

TEST(CanLogs, a_virtual_run_writes_every_frame_of_its_bus_in_its_own_time) {
  const std::string folder = scratch("logs");
  const auto lines = log_of(kMachine, folder);
  ASSERT_GT(lines.size(), 1000u);
  int syncs = 0, answers = 0;
  image::Nanoseconds before = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const candump::Line& line = lines[i];
    EXPECT_EQ(line.bus, "can");
    EXPECT_GE(line.time, before) << "line " << i + 1;
    before = line.time;
    answers += line.frame.id == 0x181;
    if (line.frame.id != 0x080) continue;
    ++syncs;
  }
  EXPECT_GT(syncs, 500);
  EXPECT_GT(answers, syncs / 2) << "the drive answers";
  EXPECT_LT(lines.front().time, 100 * image::kMillisecond) << "the beginning is 0";
}

TEST(CanLogs, two_virtual_runs_write_the_same_bytes) {
  const std::string one = scratch("one"), two = scratch("two");
  log_of(kMachine, one);
  log_of(kMachine, two);
  const std::string bytes = content(one + "/can.log");
  EXPECT_FALSE(bytes.empty());
  EXPECT_TRUE(bytes == content(two + "/can.log"));
}

TEST(CanLogs, what_is_written_is_read_by_play) {
  const std::string folder = scratch("logs");
  ASSERT_FALSE(log_of(kMachine, folder).empty());
  // Some frames of it, in their rhythm, onto a bus of their own.
  std::istringstream text(content(folder + "/can.log"));
  std::ofstream few(folder + "/few.log");
  int frames = 0;
  for (std::string line; frames < 20 && std::getline(text, line);)
    if (line.find(" 70") != std::string::npos) few << line << '\n', ++frames;
  few.close();
  ASSERT_GT(frames, 0);
  RunningServer server;
  auto bus = server.join();
  Process play({"play", "socketcand:127.0.0.1:" + std::to_string(server.address().port) + "/can0",
                folder + "/few.log", "--speed", "1000"});
  EXPECT_EQ(play.wait(), 0) << play.said();
  image::CanFrame frame;
  int heard = 0;
  while (heard < frames && wait_for(*bus, frame)) heard += (frame.id & 0x780) == 0x700;
  EXPECT_EQ(heard, frames);
}

/// Lines of a text that hold this.
int lines_with(const std::string& text, const std::string& part) {
  std::istringstream lines(text);
  int n = 0;
  for (std::string line; std::getline(lines, line);) n += line.find(part) != std::string::npos;
  return n;
}

TEST(CanLogs, are_read_by_can_utils) {
  if (shell("command -v log2asc log2long >/dev/null") != 0)
    GTEST_SKIP() << "no can-utils here; install it so: .ci/packages --tests";
  const std::string folder = scratch("logs");
  const auto lines = log_of(kMachine, folder);
  const std::string log = folder + "/can.log";
  ASSERT_EQ(shell("log2asc -I " + log + " -O " + folder + "/can.asc can"), 0);
  ASSERT_EQ(shell("log2long <" + log + " >" + folder + "/can.long"), 0);
  const auto frames = static_cast<int>(lines.size());
  EXPECT_EQ(lines_with(content(folder + "/can.asc"), " d "), frames) << "Vector ASC";
  EXPECT_EQ(lines_with(content(folder + "/can.long"), "["), frames);
  const auto syncs = std::count_if(lines.begin(), lines.end(),
                                   [](const candump::Line& line) { return line.frame.id == 0x080; });
  EXPECT_EQ(lines_with(content(folder + "/can.asc"), " 1  80  "), syncs);
}

TEST(CanLogs, of_a_machine_without_a_simulated_bus_are_refused_before_it_starts) {
  const std::string folder = scratch("none");
  const std::string machine = mill("socketcand:127.0.0.1:1/can0", patience());
  for (const char* command : {"run", "up"}) {
    std::vector<std::string> arguments = {command, machine, "--can-log", folder};
    if (std::string(command) == "run") arguments.insert(arguments.begin() + 2, square());
    Process refused(arguments);
    EXPECT_EQ(refused.wait(), 2) << command << refused.said();
    EXPECT_NE(refused.said().find("no CAN bus of this machine is simulated"), std::string::npos)
        << refused.said();
  }
  EXPECT_FALSE(std::filesystem::exists(folder + "/can.log"));
}

TEST(CanLogs, that_cannot_be_written_are_refused_before_the_machine_starts) {
  const std::string file = scratch("a_file");
  std::ofstream(file) << "in the way";
  Process refused({"run", kMachine, square(), "--virtual", "-q", "--can-log", file});
  EXPECT_NE(refused.wait(), 0);
  EXPECT_NE(refused.said().find(file), std::string::npos) << refused.said();
  EXPECT_EQ(content(file), "in the way");
}

}  // namespace
}  // namespace servogate::usercan
