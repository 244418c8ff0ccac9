// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>

#include "kernel/axis/spindle.hpp"
#include "tests/axis/rig.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::axis {
namespace {

TEST(RealTime, axis_and_spindle_allocate_nothing_in_any_phase_of_any_motion) {
  AxisConfig c = test::mill_axis();
  c.backlash = 0.02;
  c.pitch = {{-300, 0.0, 0.01}, {300, 0.02, 0.0}};
  c.homing.final_move = true;
  test::Rig rig(c);
  Spindle spindle;
  spindle.configure({}, 0);
  long cycles = 0;
  std::uint64_t allocated = 0;
  double spent_ns = 0.0;
  auto run = [&](int n) {
    for (; n > 0; --n, ++cycles) {
      rig.image.now.t_ns += rig.image.now.period_ns;
      rig.drive.cycle(rig.shared().drive_command, rig.shared().drive);
      rig.set_switches();
      const counting::Tally tally(allocated);
      const auto begin = std::chrono::steady_clock::now();
      rig.axis.read(rig.image);
      rig.axis.react(rig.reaction);
      rig.axis.command(rig.image);
      spent_ns += std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
      spindle.read(rig.image);
      spindle.command(rig.image);
    }
  };
  auto order = [&](auto&& what) {
    const counting::Tally tally(allocated);
    what();
  };
  order([&] { rig.axis.request_power(true), spindle.order(SpindleMode::cw, 1000.0); });
  run(100);
  order([&] { EXPECT_TRUE(rig.axis.home()); });
  run(30'000);
  EXPECT_TRUE(rig.axis.homed());
  order([&] { EXPECT_TRUE(rig.axis.jog_increment(-50.0)), spindle.order(SpindleMode::orient, 0.0); });
  run(300);
  rig.reaction = image::Reaction::stop_axes;
  run(300);
  rig.reaction = image::Reaction::none;
  run(100);
  order([&] { EXPECT_TRUE(rig.axis.jog_continuous(1, rig.image.now.t_ns)); });
  run(500);
  rig.drive.fault = true;
  run(100);
  order([&] { rig.axis.reset(); });
  run(100);
  EXPECT_EQ(allocated, 0u);
  std::printf("one axis: %.0f ns a cycle (clock calls included)\n", spent_ns / static_cast<double>(cycles));
}

}  // namespace
}  // namespace servogate::axis
