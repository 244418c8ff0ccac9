// SPDX-License-Identifier: Apache-2.0
// A line against the units of pymodbus, over TCP and over a pair of pseudo terminals.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "tests/comes.hpp"
#include "tests/modbus_line/rig/cycles.hpp"
#include "tests/places/places.hpp"
#include "tests/skip_here.hpp"

namespace servogate::modbus_line {
namespace {

bool pymodbus() {
  return std::system("/usr/bin/python3 -c 'import pymodbus.server, serial' 2>/dev/null") == 0;
}
constexpr const char* kMissing = "no python3-pymodbus here; install it so: .ci/packages --tests";

/// units.py, ended with the object.
class Counterpart {
 public:
  Counterpart(const std::string& wire, const std::string& where) {
    int out[2];
    if (pipe2(out, O_CLOEXEC) != 0) ADD_FAILURE() << "no pipe";
    const std::string script = tests::source_dir() + "/tests/modbus_line/counterparts/units.py";
    pid_ = fork();
    if (pid_ == 0) {
      dup2(out[1], 1);
      execl("/usr/bin/python3", "python3", script.c_str(), wire.c_str(), where.c_str(), "1", "2", nullptr);
      _exit(127);
    }
    close(out[1]);
    out_ = out[0];
    fcntl(out_, F_SETFL, O_NONBLOCK);
  }
  ~Counterpart() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    close(out_);
  }
  Counterpart(const Counterpart&) = delete;
  Counterpart& operator=(const Counterpart&) = delete;

  bool has_said(const std::string& words) {
    char bytes[4096];
    for (ssize_t n = 0; (n = read(out_, bytes, sizeof bytes)) > 0;)
      said_.append(bytes, static_cast<std::size_t>(n));
    return said_.find(words) != std::string::npos;
  }
  bool says(const std::string& words) {
    return tests::comes([&] { return has_said(words); });
  }

 private:
  pid_t pid_ = -1;
  int out_ = -1;
  std::string said_;
};

/// A port of loopback that nobody has, and that the system gives nobody who connects.
std::string free_port() {
  for (int port = 15'000 + getpid() % 10'000; port < 30'000; ++port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const bool free = bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    close(fd);
    if (free) return std::to_string(port);
  }
  ADD_FAILURE() << "no port";
  return "1";
}

/// Two serial devices with a wire between them.
class Wire {
 public:
  Wire() {
    for (End& end : ends_) {
      char name[128] = {};
      if (openpty(&end.master, &end.slave, name, nullptr, nullptr) != 0)
        ADD_FAILURE() << "no pseudo terminal";
      termios raw{};
      tcgetattr(end.slave, &raw);
      cfmakeraw(&raw);
      tcsetattr(end.slave, TCSANOW, &raw);
      end.name = name;
    }
    thread_ = std::thread([this] { carry(); });
  }
  ~Wire() {
    stop_ = true;
    thread_.join();
    for (const End& end : ends_) {
      close(end.master);
      close(end.slave);
    }
  }
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;
  const std::string& device(std::size_t end) const { return ends_[end].name; }

 private:
  struct End {
    int master = -1, slave = -1;
    std::string name;
  };
  void carry() {
    while (!stop_) {
      pollfd wanted[] = {{ends_[0].master, POLLIN, 0}, {ends_[1].master, POLLIN, 0}};
      if (poll(wanted, 2, 10) <= 0) continue;
      for (std::size_t from = 0; from < 2; ++from) {
        char bytes[512];
        if ((wanted[from].revents & POLLIN) == 0) continue;
        const ssize_t n = read(ends_[from].master, bytes, sizeof bytes);
        if (n > 0 && write(ends_[1 - from].master, bytes, static_cast<std::size_t>(n)) != n)
          ADD_FAILURE() << "the wire is full";
      }
    }
  }
  End ends_[2];
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

void judge(Cycles& cycles, Counterpart& units) {
  cycles.set_coil(0, 5, true);
  cycles.set_analog(1, 1, 1234);
  for (std::size_t u = 0; u < 2; ++u) {
    const int number = static_cast<int>(u) + 1;
    EXPECT_TRUE(cycles.until([&] { return cycles.good(u); })) << u;
    EXPECT_TRUE(cycles.until([&] { return cycles.input(u, number); })) << u;
    EXPECT_FALSE(cycles.input(u, number + 1));
    EXPECT_TRUE(cycles.until([&] { return cycles.analog(u, 3) == 100 * number + 3; })) << u;
  }
  EXPECT_TRUE(cycles.until([&] { return units.has_said("written 1 coils 0 0 0 0 0 0 1 0 0 0"); }));
  EXPECT_TRUE(cycles.until([&] { return units.has_said("written 2 registers 0 0 1234"); }));
  EXPECT_EQ(cycles.counters().of(modbus::Heard::malformed), 0u);
}

TEST(Pymodbus, serves_a_line_over_tcp_and_is_found_again_after_its_end) {
  if (!pymodbus()) SKIP_HERE(kMissing);
  const std::string port = free_port();
  modbus::LineSettings settings;
  settings.link.peer = modbus::TcpAddress{"localhost", port};
  settings.link.answer_timeout_ns = kLong;
  Cycles cycles(settings, {1, 2}, 50 * image::kMillisecond);
  {
    Counterpart units("tcp", port);
    judge(cycles, units);
  }
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == image::Quality::bad; }));
  Counterpart again("tcp", port);
  judge(cycles, again);
}

TEST(Pymodbus, serves_a_line_over_a_serial_device) {
  if (!pymodbus()) SKIP_HERE(kMissing);
  Wire wire;
  Counterpart units("rtu", wire.device(1));
  ASSERT_TRUE(units.says("ready"));
  Cycles cycles(rtu(wire.device(0), image::kSecond), {1, 2}, 200 * image::kMillisecond);
  judge(cycles, units);
}

/// The laboratory's USB serial pair: LAB_SERIAL is the control's end, LAB_SERIAL_OTHER that of the units, and
/// LAB_SERIAL_UDC the file by which its plug is pulled and put in again.
TEST(UsbSerial, serves_a_line_and_is_found_again_after_its_plug_was_pulled) {
  const char *ours = std::getenv("LAB_SERIAL"), *theirs = std::getenv("LAB_SERIAL_OTHER"),
             *plug = std::getenv("LAB_SERIAL_UDC");
  if (ours == nullptr || theirs == nullptr || plug == nullptr)
    GTEST_SKIP() << "no USB serial pair: tests/lab/lab run tests/lab/modbus-on-usb-serial TEST_MODBUS_LINE";
  std::string controller;
  std::ifstream(plug) >> controller;
  Cycles cycles(rtu(ours, image::kSecond), {1, 2}, 200 * image::kMillisecond);
  {
    Counterpart units("rtu", theirs);
    ASSERT_TRUE(units.says("ready"));
    judge(cycles, units);
  }
  std::ofstream(plug) << "\n";
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == image::Quality::bad; }));
  std::ofstream(plug) << controller;
  ASSERT_TRUE(tests::comes([&] { return access(theirs, R_OK | W_OK) == 0; }));
  Counterpart units("rtu", theirs);
  ASSERT_TRUE(units.says("ready"));
  judge(cycles, units);
}

}  // namespace
}  // namespace servogate::modbus_line
