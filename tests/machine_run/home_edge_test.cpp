// SPDX-License-Identifier: Apache-2.0
// The example mill homed on the edge of a switch alone: by its time, and by the level of a cycle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

/// X leaves its home switch at -3 mm, which is its zero; it stands at `start` at power-on.
machine::LoadResult homed_on_its_switch(bool edges, double start) {
  return changed_mill([&](std::string& text) {
    replace(text, "method = \"switch_and_index\"\nswitch = \"x_home\"",
            "method = \"switch\"\nswitch = \"x_home\"");
    replace(text, "position = \"0 mm\"", "position = \"-3 mm\"");
    if (edges)
      replace(text, "channel = \"di6\", place = \"SA6\"", "channel = \"di6\", place = \"SA6\", edges = true");
    replace(text, "start = \"37.5 mm\"", "start = \"" + std::to_string(start) + " mm\"");
  });
}

/// How far the coordinate of X is from where the slide really is, mm.
double error_of(bool edges, double start) {
  Mill mill(homed_on_its_switch(edges, start), {});
  EXPECT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.alarms(axis::alarm::kHomingNoEdge), 0);
  mill.run(0.2);
  return mill.axis("X").actual - mill.true_position(0);
}

TEST(HomeEdge, makes_the_zero_of_an_axis_repeatable_within_a_cycle) {
  const double cycle_way = 5.0 * 0.001;  // mm at the slow speed
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (int n = 0; n < 6; ++n)
    for (const bool edges : {false, true}) {
      const double error = error_of(edges, 20.0 + 1.2347 * n);
      low[edges] = std::min(low[edges], error);
      high[edges] = std::max(high[edges], error);
      EXPECT_LE(std::abs(error), edges ? 0.1 * cycle_way : 3.0 * cycle_way) << edges << " " << n;
    }
  std::cout << "repeatable within " << (high[0] - low[0]) * 1e3 << " um by the level, "
            << (high[1] - low[1]) * 1e3 << " um by the edge\n";
  EXPECT_LT(high[1] - low[1], 0.1 * cycle_way);
}

}  // namespace
}  // namespace servogate::machine_run
