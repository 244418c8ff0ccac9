// SPDX-License-Identifier: Apache-2.0
// What a port can be judged by without a device; with one: tests/lab/pendant-on-uhid.
#include "drivers/hid/hid_port.hpp"

#include <gtest/gtest.h>

namespace servogate::hid {
namespace {

TEST(HidPort, a_pendant_that_is_not_there_is_waited_for_and_says_nothing) {
  drivers::Notice why;
  const auto port = HidPort::open({0xFFFF, 0xFFFE, {}, {}}, why);
  ASSERT_NE(port, nullptr) << why.str();
  port->show({{6, 1, 2, 3}});
  drivers::PendantNews news;
  port->wait(std::chrono::milliseconds(100));
  EXPECT_FALSE(port->take(news));
}

TEST(HidPort, several_may_wait_at_the_same_time) {
  drivers::Notice why;
  const auto one = HidPort::open({0xFFFF, 0xFFFE, "A", {}}, why);
  const auto other = HidPort::open({0xFFFF, 0xFFFD, {}, "/dev/hidraw99"}, why);
  ASSERT_TRUE(one && other) << why.str();
  drivers::PendantNews news;
  EXPECT_FALSE(one->take(news));
  EXPECT_FALSE(other->take(news));
}

}  // namespace
}  // namespace servogate::hid
