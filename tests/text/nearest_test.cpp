// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/nearest.hpp"

#include <gtest/gtest.h>

namespace servogate::text {
namespace {

TEST(Nearest, finds_the_word_that_was_meant_and_none_that_is_far) {
  const std::vector<std::string> names = {"max_velocity", "max_acceleration", "lead", "home"};
  EXPECT_EQ(nearest("max_velosity", names), "max_velocity");
  EXPECT_EQ(nearest("maxvelocity", names), "max_velocity");
  EXPECT_EQ(nearest("led", names), "lead");
  EXPECT_EQ(nearest("colour", names), "");
  EXPECT_EQ(nearest(std::string(10000, 'x'), names), "");
}

}  // namespace
}  // namespace servogate::text
