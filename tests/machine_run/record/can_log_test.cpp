// SPDX-License-Identifier: Apache-2.0
// A log of a simulated bus whose writer cannot follow: its file is a pipe that nobody reads for a while.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include <string>
#include <thread>

#include "gateway/control/run/can_log.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

/// The other end of a pipe, which a log takes for its file.
class Pipe {
 public:
  explicit Pipe(const std::string& path) {
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0) << path;
    descriptor_ = open(path.c_str(), O_RDONLY | O_NONBLOCK);
  }
  ~Pipe() { close(descriptor_); }
  /// Everything until the log closes it.
  std::string read_to_end() {
    fcntl(descriptor_, F_SETFL, 0);
    std::string text;
    char part[65536];
    for (ssize_t n; (n = read(descriptor_, part, sizeof part)) > 0;)
      text.append(part, static_cast<std::size_t>(n));
    return text;
  }

 private:
  int descriptor_;
};

struct LogOnAPipe : testing::Test {
  Scratch scratch;
  Pipe pipe{scratch.path("can.log")};
  Mill mill;
  std::string read, error;

  std::uint64_t on_the_wire() { return mill.control().world().wire(0)->statistics().frames; }
  /// Ends the log while somebody reads.
  void end(gateway::CanLog& log) {
    std::thread reader([this] { read = pipe.read_to_end(); });
    error = log.close();
    reader.join();
  }
  std::uint64_t lines() const {
    return static_cast<std::uint64_t>(std::count(read.begin(), read.end(), '\n'));
  }
};

TEST_F(LogOnAPipe, counts_what_a_writer_that_cannot_follow_has_lost_and_says_it_at_the_end) {
  gateway::CanLog log(scratch.path(""), mill.control());
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").drive.online; }, 15.0)) << mill.alarm_list();
  mill.run(20.0);
  ASSERT_GT(log.lost(), 0u) << on_the_wire() << " frames";
  end(log);
  EXPECT_EQ(lines() + log.lost(), on_the_wire()) << "every frame is written or counted";
  EXPECT_EQ(error, std::to_string(log.lost()) + " frames of can are missing: the computer was too slow");
  EXPECT_EQ(mill.alarm_list(), "") << "the machine does not wait for its log";
}

TEST_F(LogOnAPipe, has_every_frame_when_the_run_waits_for_room_as_in_virtual_time) {
  gateway::CanLog log(scratch.path(""), mill.control());
  std::thread reader([this] { read = pipe.read_to_end(); });
  mill.after_cycle = [&log] { log.wait_for_room(); };
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").drive.online; }, 15.0)) << mill.alarm_list();
  mill.run(5.0);
  const std::uint64_t frames = on_the_wire();
  EXPECT_EQ(log.close(), "");
  reader.join();
  EXPECT_GT(frames, 10'000u);
  EXPECT_EQ(lines(), frames);
}

}  // namespace
}  // namespace servogate::machine_run
