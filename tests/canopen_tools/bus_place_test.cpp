// SPDX-License-Identifier: Apache-2.0
// The same bus written in different ways.
#include "machine/bus_place.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace servogate::canopen_tools {
namespace {

using machine::bus_place;

bool same(const char* a, const char* b) { return machine::same_bus(a, b); }

TEST(BusPlace, a_unix_socket_is_one_place_however_the_way_to_it_is_written) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(bus_place("socketcand:unix:bus.sock/can0"), "socketcand:unix:" + here + "/bus.sock/can0");
  EXPECT_TRUE(same("socketcand:unix:bus.sock/can0", "socketcand:unix:./nowhere/../bus.sock/can0"));
  EXPECT_FALSE(same("socketcand:unix:bus.sock/can0", "socketcand:unix:bus.sock/can1"));
}

TEST(BusPlace, a_host_is_its_number) {
  EXPECT_TRUE(same("socketcand:127.1:29536/can0", "socketcand:127.0.0.1:29536/can0"));
  EXPECT_EQ(bus_place("socketcand:no-such-host.invalid:1/can0"), "socketcand:no-such-host.invalid:1/can0");
  EXPECT_FALSE(same("socketcand:127.0.0.1:29536/can0", "socketcand:127.0.0.1:29537/can0"));
  EXPECT_TRUE(same("udp:239.74.163.2:43113", "udp:239.74.163.2:043113"));
}

TEST(BusPlace, names_of_hosts_are_looked_up_where_the_rest_is_equal) {
  EXPECT_TRUE(machine::same_bus("socketcand:localhost:1/can0", "socketcand:localhost:01/can0"));
  EXPECT_FALSE(machine::same_bus("socketcand:localhost:1/can0", "socketcand:localhost:1/can1"));
  EXPECT_FALSE(machine::same_bus("mock:can", "socketcan:can"));
  EXPECT_FALSE(machine::same_bus("", "mock:can"));
}

TEST(BusPlace, granted_time_is_on_the_bus_of_its_server) {
  EXPECT_TRUE(same("lockstep:127.0.0.1:1/can0", "socketcand:127.0.0.1:1/can0"));
}

TEST(BusPlace, an_adapter_may_be_the_only_one_and_has_a_first_channel) {
  EXPECT_TRUE(same("gsusb:any", "gsusb:003A0034"));
  EXPECT_TRUE(same("gsusb:003A0034/0", "gsusb:003A0034"));
  EXPECT_FALSE(same("gsusb:any/1", "gsusb:003A0034"));
  EXPECT_FALSE(same("gsusb:003A0035", "gsusb:003A0034"));
}

TEST(BusPlace, other_urls_are_what_they_say) {
  EXPECT_TRUE(same("socketcan:can0", "socketcan:can0"));
  EXPECT_FALSE(same("socketcan:can0", "socketcan:vcan0"));
  EXPECT_EQ(bus_place("nonsense"), "nonsense");
}

}  // namespace
}  // namespace servogate::canopen_tools
