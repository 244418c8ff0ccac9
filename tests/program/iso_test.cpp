// SPDX-License-Identifier: Apache-2.0
// What the ISO dialect of turning does beyond the commands of one program.
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"
#include "tests/program/cut_judge.hpp"

namespace servogate::program::tests {
namespace {

constexpr std::size_t kX = 0, kZ = 1;

MachineModel lathe() {
  MachineModel machine = machine_of("XZ", true, 300.0);
  machine.power_on = {"G291"};
  return machine;
}

TEST(IsoTurning, no_pass_is_deeper_than_the_programmed_depth) {
  const std::vector<Way> ways = ways_of("sinumerik-808d", lathe(),
                                        "G98 G00 X62. Z3.\nG71 U2.5 R0.5\nG71 P100 Q130 U0.8 W0.1 F100\nM30\n"
                                        "N100 G00 X20.\nN110 G01 Z-20.\nN120 X40. Z-40.\nN130 X60.\n");
  double before = 31.0;
  int passes = 0;
  for (const Way& w : ways) {
    if (w.kind != Way::Kind::cut || w.from[kX] != w.to[kX] || w.from[kZ] < 2.9) continue;
    EXPECT_LE(before - w.from[kX], 2.5 + 1e-9);
    before = w.from[kX];
    ++passes;
  }
  EXPECT_EQ(passes, 10);  // nine, and the one along the contour
}

TEST(IsoTurning, has_no_contour_in_a_typed_block) {
  Interpreter run("sinumerik-808d", lathe(), {}, "p.nc", "G00 X1.\n", {}, Position{});
  run.mdi("G71 P10 Q20 F1");
  const Step step = run.next({}, true);
  const auto* error = std::get_if<Error>(&step);
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->finding.str(), "MDI:1:1: error: G71 has no contour in a typed block [P874, 14011]");
}

TEST(IsoTurning, waits_behind_data_that_are_written_in_the_main_run) {
  MachineModel machine = lathe();
  const auto needs_sync = [&](double mask) {
    machine.variables["MD20734"] = mask;
    Interpreter run("sinumerik-808d", machine, {}, "p.nc", "G00 X1.\nG10 L2 P1 X5.\nG54 X2.\n", {},
                    Position{});
    run.next({}, false);
    return std::holds_alternative<NeedsSync>(run.next({}, false));
  };
  EXPECT_TRUE(needs_sync(0x2800));
  EXPECT_FALSE(needs_sync(0x800));
}

TEST(IsoTurning, goes_on_from_the_touch_and_not_from_the_programmed_end) {
  Interpreter run("sinumerik-808d", lathe(), {}, "p.nc", "G98 G31 Z-10. F100\nG00 W1.\n", {}, Position{});
  ASSERT_TRUE(std::holds_alternative<Command>(run.next({}, false)));
  Position touch{};
  touch[kZ] = -5.24;
  run.probed(touch);
  const Step step = run.next({}, true);
  const auto* command = std::get_if<Command>(&step);
  ASSERT_NE(command, nullptr);
  EXPECT_NEAR(std::get<Rapid>(command->what).to[kZ], -4.24, 1e-9);
}

TEST(IsoTurning, waits_for_what_a_measurement_has_found) {
  Interpreter run("sinumerik-808d", lathe(), {}, "p.nc", "G98 G31 Z-10. F100\nG00 X2.\n", {}, Position{});
  ASSERT_TRUE(std::holds_alternative<Command>(run.next({}, false)));
  EXPECT_TRUE(std::holds_alternative<NeedsSync>(run.next({}, false)));
}

}  // namespace
}  // namespace servogate::program::tests
