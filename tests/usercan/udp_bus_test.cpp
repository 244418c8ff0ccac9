// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "drivers/usercan/message_pack.hpp"
#include "drivers/usercan/udp_bus.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/skip_here.hpp"
#include "tests/usercan/rig/own_network.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

using image::CanFrame;

TEST_F(Udp, frames_reach_every_participant_but_their_sender) {
  auto a = open(43201);
  auto b = open(43201);
  auto c = open(43201);
  ASSERT_TRUE(a->send(make(0x181, {1, 2, 3})));
  CanFrame f;
  for (UdpBus* bus : {b.get(), c.get()}) {
    ASSERT_TRUE(wait_for(*bus, f));
    EXPECT_EQ(f.id, 0x181u);
    EXPECT_EQ(f.length, 3);
    EXPECT_EQ(f.data[2], 3);
  }
  EXPECT_FALSE(a->receive(f));
}

TEST_F(Udp, runs_with_ports_of_their_own_do_not_hear_each_other) {
  auto a = open(43202);
  auto b = open(43203);
  auto c = open(43202);
  ASSERT_TRUE(a->send(make(0x1, {})));
  CanFrame f;
  ASSERT_TRUE(wait_for(*c, f));
  EXPECT_FALSE(b->receive(f));
}

TEST_F(Udp, what_another_computer_sends_to_the_group_is_not_heard) {
  // A network card by which the system's routes send multicast, as on a computer in a network.
  if (shell("ip link add card type veth peer name other && ip addr add 192.0.2.1/24 dev card && "
            "ip link set card up && ip link set other up && ip route replace 239.74.163.3 dev card") != 0)
    SKIP_HERE("no network card can be made here");
  drivers::Notice why;
  const auto a = UdpBus::open({"239.74.163.3", 43208, 0}, why),
             b = UdpBus::open({"239.74.163.3", 43208, 0}, why);
  ASSERT_TRUE(a && b) << why.str(text::Language::english);
  EXPECT_EQ(shell("awk '/card/ {on = 1; next} /^[0-9]/ {on = 0} on' /proc/net/igmp | grep -qi 03A34AEF"), 1)
      << "joined on the card";
  ASSERT_TRUE(a->send(make(0x181, {1})));
  CanFrame f;
  ASSERT_TRUE(wait_for(*b, f)) << "the participants of this computer hear one another";
  EXPECT_EQ(f.id, 0x181u);
  EXPECT_EQ(shell("ip link del card"), 0);
}

TEST_F(Udp, datagrams_that_nobody_read_in_time_are_counted) {
  auto a = open(43204);
  auto b = open(43204);
  int sent = 0;
  for (; sent < 200'000; ++sent) ASSERT_TRUE(a->send(make(0x1, {1})));
  CanFrame f;
  std::uint64_t read = 0;
  while (b->receive(f)) ++read;
  ASSERT_LT(read, 200'000u) << "the kernel's buffer held everything";
  ASSERT_TRUE(a->send(make(0x2, {})));
  ASSERT_TRUE(wait_for(*b, f));
  EXPECT_EQ(read + b->lost(), 200'000u);
}

TEST_F(Udp, python_can_brings_the_simulated_drive_through_every_state_and_mode) {
  if (shell("/usr/bin/python3 -c 'import can, msgpack' 2>/dev/null") != 0)
    GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  const LivingDrive drive(open(43205), 6);
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("drive_master.py") +
                  " 6 udp_multicast 239.74.163.2 port=43205 hop_limit=0"),
            0);
}

TEST_F(Udp, nothing_is_allocated_while_frames_pass) {
  auto a = open(43206);
  auto b = open(43206);
  CanFrame f = make(0x181, {1, 2, 3});
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    a->send(f);
    b->receive(f);
  }
  EXPECT_EQ(counting::allocations(), before);
}

TEST(UdpBus, an_address_that_is_no_group_is_refused) {
  drivers::Notice why;
  EXPECT_EQ(UdpBus::open({"127.0.0.1", 43207, 0}, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("127.0.0.1 is no multicast address"), std::string::npos);
}

TEST(MessagePack, what_is_packed_is_read_by_python_can_and_back) {
  if (shell("/usr/bin/python3 -c 'import can, msgpack' 2>/dev/null") != 0)
    GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  CanFrame remote = make(0x701, {});
  remote.remote = true;
  remote.length = 1;
  CanFrame fd = make(0x18FF0001, {1});
  fd.fd = true;
  fd.length = 64;
  CanFrame switched = fd, passive = fd;
  switched.fd_flags = image::kBitRateSwitch;
  passive.fd_flags = image::kErrorStateIndicator;
  const std::vector<CanFrame> frames = {
      make(0x181, {1, 2, 3}), make(0, {}), make(0x1FFFFFFF, {9}), remote, fd, switched, passive};
  const std::string file = scratch("packet");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::array<std::uint8_t, kMaxPacket> packet;
    const std::size_t size = pack(frames[i], 12.5, packet);
    std::ofstream(file + std::to_string(i))
        .write(reinterpret_cast<const char*>(packet.data()), static_cast<std::streamsize>(size));
  }
  ASSERT_EQ(shell("/usr/bin/python3 -c \"from can.interfaces.udp_multicast.utils import *\n"
                  "for i in range(" +
                  std::to_string(frames.size()) + "):\n  name = '" + file +
                  "%d' % i\n"
                  "  m = unpack_message(open(name, 'rb').read(), check=True)\n"
                  "  assert m.timestamp == 12.5\n"
                  "  open(name, 'wb').write(pack_message(m))\""),
            0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string back = content(file + std::to_string(i));
    CanFrame again;
    ASSERT_TRUE(unpack({reinterpret_cast<const std::uint8_t*>(back.data()), back.size()}, again));
    EXPECT_EQ(again.id, frames[i].id);
    EXPECT_EQ(again.extended, frames[i].extended);
    EXPECT_EQ(again.remote, frames[i].remote);
    EXPECT_EQ(again.fd, frames[i].fd);
    EXPECT_EQ(again.fd_flags, frames[i].fd_flags);
    EXPECT_EQ(again.length, frames[i].length);
    EXPECT_EQ(again.data, frames[i].data);
  }
}

TEST(MessagePack, a_packet_cut_short_anywhere_or_with_a_wrong_byte_is_refused_or_read_but_never_overrun) {
  std::array<std::uint8_t, kMaxPacket> packet;
  const std::size_t size = pack(make(0x181, {1, 2, 3, 4, 5, 6, 7, 8}), 1.0, packet);
  CanFrame f;
  for (std::size_t n = 0; n < size; ++n) {
    const std::vector<std::uint8_t> cut(packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(unpack(cut, f)) << n;
  }
  for (std::size_t n = 0; n < size; ++n)
    for (int b = 0; b < 256; ++b) {
      std::vector<std::uint8_t> bent(packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(size));
      bent[n] = static_cast<std::uint8_t>(b);
      EXPECT_TRUE(!unpack(bent, f) || f.length <= 64);
    }
}

}  // namespace
}  // namespace servogate::usercan
