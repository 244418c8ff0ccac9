// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/touch.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/property_seed.hpp"

namespace servogate::channel {
namespace {

double place_of(const program::Command& command) {
  if (const auto* probe = std::get_if<program::Probe>(&command.what)) return probe->to[0];
  return std::get<program::Line>(command.what).to[0];
}

TEST(Touch, never_leaves_the_way_that_was_ordered_wherever_the_surface_stands) {
  std::mt19937_64 random(test::property_seed());
  const auto mm = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int n = 0; n < 1000; ++n) {
    program::Position from{};
    from[0] = mm(-50.0, 50.0);
    const double by = mm(0.1, 40.0) * (n % 2 == 0 ? 1.0 : -1.0), back = mm(0.01, std::abs(by));
    const double surface = from[0] + by * mm(0.0, 1.0);
    Touch touch({.axis = 0, .by = by, .fast = 200.0, .slow = 20.0, .back = back, .times = 3}, from);
    const double low = std::min(from[0], from[0] + by), high = std::max(from[0], from[0] + by);
    int slow = 0;
    while (const auto command = touch.next()) {
      ASSERT_GE(place_of(*command), low - 1e-9) << "by " << by << ", back " << back;
      ASSERT_LE(place_of(*command), high + 1e-9) << "by " << by << ", back " << back;
      if (std::holds_alternative<program::Probe>(command->what)) {
        ++slow;
        touch.touched(surface);
      }
    }
    EXPECT_EQ(slow, 4);
    EXPECT_EQ(touch.places().size(), 3u);
  }
}

}  // namespace
}  // namespace servogate::channel
