// SPDX-License-Identifier: Apache-2.0
#include "tests/socketcan/vcan.hpp"
#include "tests/comes.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "tests/skip_here.hpp"

namespace servogate::socketcan {

bool shell(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()) == 0; }

std::string output_of(const std::string& command) {
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r"); pipe != nullptr) {
    std::array<char, 256> part;
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    pclose(pipe);
  }
  return text;
}

void Vcan::SetUp() {
  static int count = 0;
  name_ = "vt" + std::to_string(getpid() % 100000) + "x" + std::to_string(count++);
  if (!shell("ip link add " + name_ + " type vcan && ip link set " + name_ + " mtu 72 up"))
    SKIP_HERE("no vcan here; run it so: tests/lab/lab run ctest --test-dir build/release -R socketcan");
}

void Vcan::TearDown() { shell("ip link del " + name_); }

std::unique_ptr<SocketCanBus> Vcan::open(SocketCanConfig config) {
  config.interface = name_;
  drivers::Notice why;
  auto bus = SocketCanBus::open(config, why);
  EXPECT_NE(bus, nullptr) << why.str(text::Language::english);
  return bus;
}

bool Vcan::wait_for(SocketCanBus& bus, image::CanFrame& frame) {
  return tests::comes([&] { return bus.receive(frame); }, std::chrono::milliseconds(1));
}

bool Vcan::reaches(SocketCanBus& bus, image::CanState state) {
  image::CanFrame frame;
  return tests::comes([&] {
    while (bus.receive(frame)) {
    }
    return bus.state() == state;
  });
}

}  // namespace servogate::socketcan
