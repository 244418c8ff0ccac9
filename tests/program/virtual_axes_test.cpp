// SPDX-License-Identifier: Apache-2.0
// Virtual axes against geometry of its own: where the chords of the machine lie, and how fast they are
// passed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "kernel/program/check/canon.hpp"
#include "tests/program/case_file.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLeast = 5.0, kFeed = 300.0;

struct Point2 {
  double u, v;
};

MachineModel turntable() {
  MachineModel machine = mill();
  machine.axes[1].letter = "C";
  machine.axes[1].rotary = true;
  machine.axes[1].travel_min = -1e6;
  machine.axes[1].travel_max = 1e6;
  return machine;
}

std::vector<Command> commands_of(const std::string& program, const MachineModel& machine,
                                 const Position& start, std::string& error) {
  std::vector<Command> out;
  Interpreter interpreter("nc110", machine, {}, "p.nc", program, {}, start);
  const auto found = run_dry(
      interpreter,
      [&](const Command& command) {
        out.push_back(command);
        return true;
      },
      kDryRunBlocks);
  error = found ? found->str(text::Language::english) : "";
  return out;
}

Point2 polar(double x, double c) { return {x * std::cos(c * kDegree), x * std::sin(c * kDegree)}; }

double from_line(Point2 p, Point2 a, Point2 b) {
  const double dx = b.u - a.u, dy = b.v - a.v, square = dx * dx + dy * dy;
  const double s = square == 0.0 ? 0.0 : std::clamp(((p.u - a.u) * dx + (p.v - a.v) * dy) / square, 0.0, 1.0);
  return std::hypot(p.u - a.u - s * dx, p.v - a.v - s * dy);
}

class Polar : public ::testing::Test {
 protected:
  Polar() : random_(servogate::test::property_seed()) {}
  double between(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  double rounded(double low, double high) { return std::round(between(low, high) * 1e4) / 1e4; }

  std::mt19937_64 random_;
};

TEST_F(Polar, lines_are_left_by_less_than_a_micrometre_and_passed_with_the_programmed_feed) {
  int refused = 0;
  for (int round = 0; round < 200; ++round) {
    const Point2 a{rounded(-100, 100), rounded(-100, 100)}, b{rounded(-100, 100), rounded(-100, 100)};
    char program[200];
    std::snprintf(program, sizeof program, "(UAV,1,XC,UV,5)\nG0 U%.4f V%.4f\nG29 G1 U%.4f V%.4f F300\n", a.u,
                  a.v, b.u, b.v);
    std::string error;
    const auto commands = commands_of(program, turntable(), {120.0}, error);
    const double nearest = from_line({0.0, 0.0}, a, b);
    if (nearest < kLeast - 1e-3) {
      EXPECT_NE(error.find("P753"), std::string::npos) << program << error;
      ++refused;
      continue;
    }
    ASSERT_EQ(error, "") << program;
    double x = 120.0, c = 0.0, seconds = 0.0;
    for (const Command& command : commands) {
      if (const auto* rapid = std::get_if<Rapid>(&command.what)) x = rapid->to[0], c = rapid->to[1];
      const auto* line = std::get_if<Line>(&command.what);
      if (line == nullptr) continue;
      EXPECT_EQ(line->feed.unit, FeedUnit::inverse_time);
      seconds += 60.0 / line->feed.value;
      for (int i = 0; i <= 8; ++i) {
        const double s = i / 8.0;
        const Point2 p = polar(x + (line->to[0] - x) * s, c + (line->to[1] - c) * s);
        EXPECT_LT(from_line(p, a, b), 0.001) << program;
      }
      x = line->to[0], c = line->to[1];
    }
    const Point2 end = polar(x, c);
    EXPECT_NEAR(end.u, b.u, 1e-6);
    EXPECT_NEAR(end.v, b.v, 1e-6);
    EXPECT_NEAR(seconds, std::hypot(b.u - a.u, b.v - a.v) * 60.0 / kFeed, 1e-6);
  }
  EXPECT_LT(refused, 100);
}

TEST_F(Polar,
       full_circles_are_left_by_less_than_a_micrometre_and_turn_the_table_as_often_as_they_surround_it) {
  for (int round = 0; round < 100; ++round) {
    const Point2 centre{rounded(-60, 60), rounded(-60, 60)};
    const double radius = rounded(8, 60), far = std::hypot(centre.u, centre.v);
    if (std::abs(far - radius) < kLeast + 0.01) continue;
    const double u = std::round((centre.u + radius) * 1e4) / 1e4;
    if (std::hypot(u, centre.v) < kLeast + 0.01) continue;
    char program[240];
    std::snprintf(program, sizeof program,
                  "(UAV,1,XC,UV,5)\n(DPI,U,V)\nG0 U%.4f V%.4f\nG29 G3 U%.4f V%.4f I%.4f J%.4f F300\n", u,
                  centre.v, u, centre.v, centre.u, centre.v);
    std::string error;
    const auto commands = commands_of(program, turntable(), {120.0}, error);
    ASSERT_EQ(error, "") << program;
    double x = 120.0, c = 0.0, begin = 0.0, seconds = 0.0;
    for (const Command& command : commands) {
      if (const auto* rapid = std::get_if<Rapid>(&command.what)) x = rapid->to[0], begin = c = rapid->to[1];
      const auto* line = std::get_if<Line>(&command.what);
      if (line == nullptr) continue;
      seconds += 60.0 / line->feed.value;
      for (int i = 0; i <= 8; ++i) {
        const double s = i / 8.0;
        const Point2 p = polar(x + (line->to[0] - x) * s, c + (line->to[1] - c) * s);
        EXPECT_NEAR(std::hypot(p.u - centre.u, p.v - centre.v), radius, 0.001) << program;
      }
      x = line->to[0], c = line->to[1];
    }
    EXPECT_NEAR(c - begin, far < radius ? 360.0 : 0.0, 1e-6) << program;
    EXPECT_NEAR(seconds, 2.0 * std::numbers::pi * radius * 60.0 / kFeed, 1e-3);
  }
}

TEST(Space, leaves_nothing_behind_for_axes_that_the_machine_does_not_have) {
  std::string error;
  const auto commands =
      commands_of("(UAV,4,XYZ,UVW,0,0,90)\nG0 U10 V20 W5\n(UAV,0)\nX1\n(UAV,4,XYZ,UVW,0,0,0)\nV3\nM30\n",
                  mill(), {}, error);
  ASSERT_EQ(error, "");
  for (const Command& command : commands) {
    const auto* rapid = std::get_if<Rapid>(&command.what);
    if (rapid == nullptr) continue;
    for (std::size_t a = 3; a < rapid->to.size(); ++a) EXPECT_EQ(rapid->to[a], 0.0) << command.line;
  }
}

TEST(Space, a_turned_system_keeps_every_length_and_angle) {
  std::mt19937_64 random(servogate::test::property_seed());
  std::uniform_real_distribution<> angle(-180.0, 180.0), place(-90.0, 90.0);
  for (int round = 0; round < 200; ++round) {
    std::array<double, 3> p{}, q{};
    for (std::size_t i = 0; i < 3; ++i) p[i] = place(random), q[i] = place(random);
    char program[240];
    std::snprintf(program, sizeof program,
                  "(UAV,4,XYZ,UVW,%.4f,%.4f,%.4f)\nG0 U%.4f V%.4f W%.4f\nU%.4f V%.4f W%.4f\n", angle(random),
                  angle(random), angle(random), p[0], p[1], p[2], q[0], q[1], q[2]);
    std::string error;
    const auto commands = commands_of(program, mill(), {}, error);
    ASSERT_EQ(error, "") << program;
    const Position a = std::get<Rapid>(commands.at(0).what).to, b = std::get<Rapid>(commands.at(1).what).to;
    double dot = 0.0, wanted = 0.0;
    for (std::size_t i = 0; i < 3; ++i) dot += a[i] * b[i], wanted += p[i] * q[i];
    EXPECT_NEAR(dot, wanted, 0.05) << program;
    EXPECT_NEAR(std::hypot(a[0], a[1], a[2]), std::hypot(p[0], p[1], p[2]), 1e-3);
  }
}

}  // namespace
}  // namespace servogate::program::tests
