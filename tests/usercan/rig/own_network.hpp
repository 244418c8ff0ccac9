// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>

#include "drivers/usercan/udp_bus.hpp"

namespace servogate::usercan {

/// Multicast in a network of the test program's own, which processes that it starts have, too.
class Udp : public ::testing::Test {
 protected:
  void SetUp() override;
  static std::unique_ptr<UdpBus> open(std::uint16_t port);
  /// The same as a url.
  static std::string url(std::uint16_t port) { return "udp:239.74.163.2:" + std::to_string(port); }
};

}  // namespace servogate::usercan
