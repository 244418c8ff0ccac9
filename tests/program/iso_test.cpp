// SPDX-License-Identifier: Apache-2.0
// Cycles of the ISO dialect judged by geometry of their own: what they cut, and what they leave.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/interpreter/interpreter.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

constexpr std::size_t kX = 0, kZ = 1;
constexpr double kTolerance = 2e-3;  ///< mm: numbers of programs have three decimals

MachineModel lathe() {
  MachineModel machine;
  for (const char* letter : {"X", "Z"}) {
    MachineModel::Axis axis;
    axis.letter = letter;
    axis.diameter = axis.letter == "X";
    axis.travel_min = -300.0;
    axis.travel_max = 300.0;
    axis.rapid = 500.0;
    machine.axes.push_back(axis);
  }
  machine.power_on = {"G291"};
  machine.kind = MachineModel::Kind::turning;
  return machine;
}

struct Stroke {
  double x0, z0, x1, z1;
  bool cuts;
};

std::vector<Stroke> strokes_of(const std::string& program, std::optional<text::Finding>& error) {
  std::vector<Stroke> strokes;
  Interpreter run("sinumerik-808d", lathe(), {}, "p.nc", program, {}, Position{});
  Position at{};
  error = run_dry(
      run,
      [&](const Command& command) {
        const auto* rapid = std::get_if<Rapid>(&command.what);
        const auto* line = std::get_if<Line>(&command.what);
        if (rapid == nullptr && line == nullptr) return true;
        const Position& to = rapid != nullptr ? rapid->to : line->to;
        strokes.push_back({at[kX], at[kZ], to[kX], to[kZ], line != nullptr});
        at = to;
        return true;
      },
      100'000);
  return strokes;
}

/// Radius of a contour of straight parts at a place of Z, which falls from point to point.
struct Contour {
  std::vector<std::pair<double, double>> points;  ///< z, x
  double at(double z, bool larger) const {
    double found = larger ? -1e9 : 1e9;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto [z0, x0] = points[i - 1];
      const auto [z1, x1] = points[i];
      if (z > z0 + 1e-9 || z < z1 - 1e-9) continue;
      const double low = z0 == z1 ? std::min(x0, x1) : x0 + (x1 - x0) * (z - z0) / (z1 - z0);
      const double high = z0 == z1 ? std::max(x0, x1) : low;
      found = larger ? std::max(found, high) : std::min(found, low);
    }
    return found;
  }
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

double rounded(double value) { return std::round(value * 1000.0) / 1000.0; }

TEST(IsoTurning, stock_removal_never_cuts_below_its_allowance_and_leaves_no_more_than_it) {
  std::mt19937_64 random(servogate::test::property_seed());
  const auto pick = [&](double low, double high) {
    return rounded(std::uniform_real_distribution<double>(low, high)(random));
  };
  for (int n = 0; n < 300; ++n) {
    Contour contour;
    double x = pick(3.0, 8.0), z = 2.0;
    contour.points.push_back({z, x});
    std::string blocks;
    int block = 10;
    const int parts = 2 + static_cast<int>(random() % 5);
    for (int i = 0; i < parts; ++i) {
      if (i > 0 && random() % 3 == 0) {
        x += pick(0.5, 4.0);  // a shoulder
      } else {
        z -= pick(1.0, 12.0);
        if (i > 0 && random() % 2 == 0) x += pick(0.1, 5.0);
      }
      contour.points.push_back({z, x});
      block += 10;
      blocks += "N" + std::to_string(block) + " G01 X" + number(2.0 * x) + " Z" + number(z) + "\n";
    }
    const double u = pick(0.0, 1.0), w = pick(0.0, 0.5), start = x + pick(1.0, 6.0);
    const std::string program = "G98 G00 X" + number(2.0 * start) + " Z2.\nG71 U" + number(pick(0.5, 6.0)) +
                                " R" + number(pick(0.1, 0.9)) + "\nG71 P10 Q" + std::to_string(block) + " U" +
                                number(2.0 * u) + " W" + number(w) + " F200\nM30\nN10 G00 X" +
                                number(2.0 * contour.points[0].second) + "\n" + blocks;
    std::optional<text::Finding> error;
    const std::vector<Stroke> strokes = strokes_of(program, error);
    ASSERT_FALSE(error) << error->str() << "\n" << program;
    ASSERT_GT(strokes.size(), 2u);
    Contour allowed = contour;
    for (auto& [pz, px] : allowed.points) pz += w, px += u;
    for (std::size_t n0 = 1; n0 < strokes.size(); ++n0)  // behind the way to the blank
      for (int i = 0; i <= 40; ++i) {
        const Stroke& s = strokes[n0];
        const double share = i / 40.0, sz = s.z0 + (s.z1 - s.z0) * share, sx = s.x0 + (s.x1 - s.x0) * share;
        if (sz > allowed.points.front().first || sz < allowed.points.back().first) continue;
        ASSERT_GE(sx, allowed.at(sz, false) - kTolerance) << "z " << sz << "\n" << program;
      }
    for (int i = 1; i < 50; ++i) {
      const double place = allowed.points.back().first +
                           (allowed.points.front().first - allowed.points.back().first) * i / 50.0;
      double deepest = 1e9;
      for (const Stroke& s : strokes) {
        if (!s.cuts || place > std::max(s.z0, s.z1) || place < std::min(s.z0, s.z1) || s.z0 == s.z1) continue;
        deepest = std::min(deepest, s.x0 + (s.x1 - s.x0) * (place - s.z0) / (s.z1 - s.z0));
      }
      ASSERT_LE(deepest, allowed.at(place, true) + kTolerance) << "z " << place << "\n" << program;
    }
    ASSERT_NEAR(strokes.back().x1, rounded(start), kTolerance);
    ASSERT_NEAR(strokes.back().z1, 2.0, kTolerance);
  }
}

TEST(IsoTurning, no_pass_is_deeper_than_the_programmed_depth) {
  std::optional<text::Finding> error;
  const std::vector<Stroke> strokes = strokes_of(
      "G98 G00 X62. Z3.\nG71 U2.5 R0.5\nG71 P100 Q130 U0.8 W0.1 F100\nM30\nN100 G00 X20.\nN110 G01 "
      "Z-20.\nN120 X40. "
      "Z-40.\nN130 X60.\n",
      error);
  ASSERT_FALSE(error);
  double before = 31.0;
  int passes = 0;
  for (const Stroke& s : strokes) {
    if (!s.cuts || s.x0 != s.x1 || s.z0 < 2.9) continue;
    EXPECT_LE(before - s.x0, 2.5 + 1e-9);
    before = s.x0;
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
