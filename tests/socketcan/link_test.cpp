// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <linux/tty.h>
#include <net/if.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

#include "tests/comes.hpp"
#include "tests/skip_here.hpp"
#include "tests/socketcan/vcan.hpp"

namespace servogate::socketcan {
namespace {

using image::CanFrame;
using image::CanState;

std::string refusal(const SocketCanConfig& config) {
  drivers::Notice why;
  EXPECT_EQ(SocketCanBus::open(config, why), nullptr);
  return why.str(text::Language::english);
}

TEST(SocketCan, a_kernel_without_CAN_is_said_with_what_helps) {
  if (shell("ip link add vtprobe type vcan && ip link del vtprobe")) GTEST_SKIP() << "this kernel has CAN";
  EXPECT_NE(refusal({"can0", 0, {}}).find("modprobe can-raw"), std::string::npos);
}

TEST_F(Vcan, an_interface_that_is_missing_is_named_with_those_that_are_there) {
  const std::string why = refusal({"can77", 0, {}});
  EXPECT_NE(why.find("can77"), std::string::npos);
  EXPECT_NE(why.find(name_), std::string::npos);
  EXPECT_NE(why.find("ip link add can77 type vcan"), std::string::npos);
}

TEST_F(Vcan, an_interface_that_is_down_is_named_with_the_command_that_brings_it_up) {
  ASSERT_TRUE(shell("ip link set " + name_ + " down"));
  const std::string why = refusal({name_, 500'000, {}});
  EXPECT_EQ(why, name_ + " is down; bring it up with: ip link set " + name_ + " up");
  const std::string command = why.substr(why.find("ip link"));
  ASSERT_TRUE(shell(command));
  EXPECT_NE(open(), nullptr);
}

TEST_F(Vcan, the_loopback_interface_is_no_CAN_interface) {
  EXPECT_EQ(refusal({"lo", 0, {}}), "lo is no CAN interface");
}

TEST_F(Vcan, the_kernel_says_kind_state_and_the_size_of_frames) {
  const auto link = read_link(name_);
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_TRUE(link->is_can);
  EXPECT_TRUE(link->up);
  EXPECT_TRUE(link->fd);
  EXPECT_EQ(link->state, CanState::error_active);
}

TEST_F(Vcan, a_bus_without_a_rate_of_its_own_has_that_of_the_plan) {
  EXPECT_EQ(open({{}, 250'000, {}})->bit_rate(), 250'000u);
}

TEST_F(Vcan, error_frames_tell_the_state_of_the_controller) {
  auto bus = open();
  const auto error = [&](const std::string& frame) { return shell("cansend " + name_ + " " + frame); };
  CanFrame f;
  ASSERT_TRUE(error("20000004#0008000000000000"));  // CAN_ERR_CRTL, transmitter at warning level
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_TRUE(f.error);
  EXPECT_EQ(f.id, 0x4u);
  EXPECT_EQ(bus->state(), CanState::error_warning);
  ASSERT_TRUE(error("20000004#0020000000000000"));  // transmitter passive
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(bus->state(), CanState::error_passive);
  ASSERT_TRUE(error("20000040#0000000000000000"));  // bus-off
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(bus->state(), CanState::bus_off);
  f = {};
  f.id = 0x123;
  EXPECT_FALSE(bus->send(f)) << "nobody hears it";
  ASSERT_TRUE(error("20000100#0000000000000000"));  // restarted
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(bus->state(), CanState::error_active);
  f = {};
  f.id = 0x123;
  EXPECT_TRUE(bus->send(f));
  EXPECT_EQ(bus->statistics().errors, 4u);
}

TEST_F(Vcan, a_link_that_goes_down_and_comes_back_is_noticed_without_reopening) {
  auto bus = open();
  auto other = open();
  ASSERT_TRUE(shell("ip link set " + name_ + " down"));
  EXPECT_TRUE(reaches(*bus, CanState::down));
  CanFrame f;
  f.id = 0x181;
  EXPECT_FALSE(bus->send(f));
  ASSERT_TRUE(shell("ip link set " + name_ + " up"));
  EXPECT_TRUE(reaches(*bus, CanState::error_active));
  EXPECT_TRUE(reaches(*other, CanState::error_active));
  EXPECT_TRUE(bus->send(f));
  ASSERT_TRUE(wait_for(*other, f));
  EXPECT_EQ(f.id, 0x181u);
}

TEST_F(Vcan, a_link_is_taken_down_and_brought_up_by_the_program_itself) {
  auto bus = open();
  ASSERT_EQ(set_link(read_link(name_)->index, {.up = false}), 0);
  EXPECT_FALSE(read_link(name_)->up);
  EXPECT_TRUE(reaches(*bus, CanState::down));
  ASSERT_EQ(set_link(read_link(name_)->index, {.up = true}), 0);
  EXPECT_TRUE(read_link(name_)->up);
  EXPECT_TRUE(reaches(*bus, CanState::error_active));
}

TEST_F(Vcan, a_link_that_is_restarted_is_there_again_as_it_was) {
  auto bus = open();
  ASSERT_EQ(restart_link(read_link(name_)->index), 0);
  EXPECT_TRUE(read_link(name_)->up);
  EXPECT_TRUE(reaches(*bus, CanState::error_active));
  EXPECT_EQ(restart_link(99'999), ENODEV);
}

TEST_F(Vcan, what_only_a_controller_can_is_refused_and_changes_nothing) {
  const int index = read_link(name_)->index;
  EXPECT_NE(set_link(index, {.bit_rate = 125'000}), 0);
  EXPECT_NE(set_link(index, {.listen_only = true}), 0);
  EXPECT_TRUE(read_link(name_)->up);
  EXPECT_EQ(set_link(99'999, {.up = true}), ENODEV);
}

/// An slcan interface on a pseudo-terminal: its queue fills when nobody reads the terminal.
class SlcanQueue : public Vcan {
 protected:
  void SetUp() override {
    int slave = -1;
    if (openpty(&far_end_, &slave, nullptr, nullptr, nullptr) != 0)
      SKIP_HERE(
          "no pseudo-terminal; run it so: tests/lab/lab run ctest --test-dir build/release -R socketcan");
    near_end_ = slave;
    termios raw{};
    tcgetattr(slave, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave, TCSANOW, &raw);
    const int discipline = N_SLCAN;
    ifreq request{};
    if (ioctl(slave, TIOCSETD, &discipline) != 0 || ioctl(slave, SIOCGIFNAME, &request) != 0)
      SKIP_HERE("no slcan here; run it so: tests/lab/lab run ctest --test-dir build/release -R socketcan");
    name_ = request.ifr_name;
    ASSERT_TRUE(shell("ip link set " + name_ + " up"));
  }
  void TearDown() override {
    if (near_end_ >= 0) close(near_end_);
    if (far_end_ >= 0) close(far_end_);
  }
  int near_end_ = -1, far_end_ = -1;
};

TEST_F(SlcanQueue, frames_beyond_the_kernels_queue_wait_and_leave_by_priority_none_lost) {
  auto bus = open();
  ASSERT_NE(bus, nullptr);
  CanFrame f;
  f.length = 8;
  // The terminal and the kernel's queue take some; then only the most important ones may overtake.
  std::uint32_t sent = 0;
  while (bus->waiting() == 0 && sent < 5000) {
    f.id = 0x700;
    ASSERT_TRUE(bus->send(f));
    ++sent;
  }
  ASSERT_GT(bus->waiting(), 0u);
  for (const std::uint32_t id : {0x600u, 0x080u, 0x201u, 0x000u}) {
    f.id = id;
    ASSERT_TRUE(bus->send(f));
  }
  EXPECT_GE(bus->statistics().waited, 5u);
  std::string line, order;
  fcntl(far_end_, F_SETFL, O_NONBLOCK);
  std::uint32_t heard = 0;
  EXPECT_TRUE(tests::comes([&] {
    bus->receive(f);
    char c = 0;
    while (read(far_end_, &c, 1) == 1) {
      if (c != '\r') {
        line += c;
        continue;
      }
      ++heard;
      if (line.substr(0, 4) != "t700") order += line.substr(1, 3) + " ";
      line.clear();
    }
    return heard >= sent + 4;
  }));
  EXPECT_EQ(heard, sent + 4);
  EXPECT_EQ(order, "000 080 201 600 ");
  EXPECT_EQ(bus->lost(), 0u);
}

TEST_F(SlcanQueue, a_full_queue_refuses_and_a_link_that_goes_down_counts_what_it_loses) {
  auto bus = open();
  ASSERT_NE(bus, nullptr);
  CanFrame f;
  f.length = 8;
  f.id = 0x123;
  int accepted = 0;
  while (accepted < 10'000 && bus->send(f)) ++accepted;
  ASSERT_LT(accepted, 10'000);
  ASSERT_EQ(bus->waiting(), drivers::SendQueue::kCapacity);
  ASSERT_TRUE(shell("ip link set " + name_ + " down"));
  EXPECT_TRUE(reaches(*bus, CanState::down));
  EXPECT_EQ(bus->waiting(), 0u);
  EXPECT_EQ(bus->lost(), drivers::SendQueue::kCapacity);
}

}  // namespace
}  // namespace servogate::socketcan
