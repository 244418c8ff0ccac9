// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "drivers/socketcan/socketcan_bus.hpp"

namespace servogate::socketcan {

/// Runs a shell command; true when it ended with 0.
bool shell(const std::string& command);
/// What a shell command prints.
std::string output_of(const std::string& command);

/// An interface of its own for each test, gone when the test has ended.
class Vcan : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Opens the test's interface; fails the test when that is refused.
  std::unique_ptr<SocketCanBus> open(SocketCanConfig config = {});
  /// Waits for a frame, nothing else.
  static bool wait_for(SocketCanBus& bus, image::CanFrame& frame);
  /// Reads until the state is this one.
  static bool reaches(SocketCanBus& bus, image::CanState state);

  std::string name_;
};

}  // namespace servogate::socketcan
