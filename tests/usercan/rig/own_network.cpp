// SPDX-License-Identifier: Apache-2.0
#include "tests/usercan/rig/own_network.hpp"

#include <sched.h>
#include <unistd.h>

#include <fstream>

#include "tests/skip_here.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {

namespace {

void write_file(const std::string& file, const std::string& text) {
  std::ofstream(file) << text << std::flush;
}

/// Root's right, or that of a user namespace.
bool own_network() {
  static const bool made = [] {
    const std::string user = std::to_string(getuid()), group = std::to_string(getgid());
    if (unshare(CLONE_NEWNET) != 0) {
      if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
      write_file("/proc/self/setgroups", "deny");
      write_file("/proc/self/uid_map", "0 " + user + " 1");
      write_file("/proc/self/gid_map", "0 " + group + " 1");
    }
    return shell("ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo") == 0;
  }();
  return made;
}

}  // namespace

void Udp::SetUp() {
  if (!own_network())
    SKIP_HERE(
        "no network namespace here; run it as root, or so: tests/lab/lab run ctest --test-dir build/release "
        "-R usercan");
}

std::unique_ptr<UdpBus> Udp::open(std::uint16_t port) {
  drivers::Notice why;
  auto bus = UdpBus::open({"239.74.163.2", port, 1'000'000}, why);
  EXPECT_NE(bus, nullptr) << why.str(text::Language::english);
  return bus;
}

}  // namespace servogate::usercan
