// SPDX-License-Identifier: Apache-2.0
// Random programs under random hands: single blocks, holds, overrides and ways back along the path at any
// time. Judged by set-points and program alone, with nothing of the planner.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/channel/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::channel::test {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;
using Point = std::array<double, kAxes>;

/// A program, and the way it describes as a polyline that leaves its arcs by no more than 0.2 um.
struct Way {
  std::string program;
  std::vector<Point> points{{0, 0, 0}};
};

class Maker {
 public:
  explicit Maker(std::mt19937_64& random) : random_(random) {}

  Way make() {
    line(1, 0);
    program_.insert(0, "G1 F" + number(between(600, 9000)) + " ");
    for (int n = 0; n < 40; ++n) {
      heading_ += between(-1.5, 1.5);
      const double length = between(0.5, 12.0);
      const int kind = static_cast<int>(random_() % 4);
      if (kind == 0)
        for (int k = 0; k < 30; ++k) {
          heading_ += 0.05;
          line(x_ + 0.3 * std::cos(heading_), y_ + 0.3 * std::sin(heading_));
        }
      else if (kind == 1)
        half_turn(x_ + length * std::cos(heading_), y_ + length * std::sin(heading_), random_() % 2 == 0);
      else
        line(x_ + length * std::cos(heading_), y_ + length * std::sin(heading_));
    }
    return {program_ + "M30\n", points_};
  }

 private:
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  /// As fine as a program may be.
  static std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", v);
    return text;
  }
  /// As it is read back from the program.
  void go(double x, double y) {
    x_ = std::stod(number(x));
    y_ = std::stod(number(y));
  }
  void line(double x, double y) {
    go(x, y);
    program_ += "X" + number(x_) + " Y" + number(y_) + "\n";
    points_.push_back({x_, y_, 0});
  }
  void half_turn(double cx, double cy, bool clockwise) {
    const double x0 = x_, y0 = y_, r = std::hypot(x0 - cx, y0 - cy), begin = std::atan2(y0 - cy, x0 - cx);
    const double step = 2.0 * std::acos(1.0 - std::min(1.0, 0.0002 / r));
    const int parts = static_cast<int>(std::ceil(std::numbers::pi / step));
    for (int k = 1; k < parts; ++k) {
      const double a = begin + (clockwise ? -1.0 : 1.0) * std::numbers::pi * k / parts;
      points_.push_back({cx + r * std::cos(a), cy + r * std::sin(a), 0});
    }
    go(2 * cx - x0, 2 * cy - y0);
    program_ += (clockwise ? "G2 X" : "G3 X") + number(x_) + " Y" + number(y_) + " I" + number(cx) + " J" +
                number(cy) + "\nG1\n";
    points_.push_back({x_, y_, 0});
  }

  std::mt19937_64& random_;
  std::string program_;
  std::vector<Point> points_{{0, 0, 0}};
  double x_ = 0.0, y_ = 0.0, heading_ = 0.0;
};

/// Somebody who cannot leave the buttons alone.
class Hands {
 public:
  Hands(Rig& rig, std::mt19937_64& random) : rig_(rig), random_(random) {}

  void work() {
    const bool single = random_() % 3 == 0;
    if (single) ask(RequestKind::mode, static_cast<double>(image::Mode::step));
    ASSERT_EQ(rig_.ask(single ? RequestKind::step : RequestKind::start), Refusal::none);
    for (int n = 0; n < 60 && rig_.state() != ProcessState::ended && !testing::Test::HasFatalFailure(); ++n) {
      rig_.run(0.001 * static_cast<double>(20 + random_() % 600));
      act();
    }
    rig_.logic.feed_override = 100;
  }
  /// Lets the program come to its end.
  bool finish() {
    return rig_.until(
        [&] {
          if (rig_.state() == ProcessState::held) rig_.ask(RequestKind::resume);
          if (rig_.state() == ProcessState::waiting) run_on();
          return rig_.state() == ProcessState::ended;
        },
        400.0);
  }
  int held = 0, retraced = 0, steps = 0;

 private:
  void ask(RequestKind kind, double value = 0.0) { ASSERT_EQ(rig_.ask(kind, value), Refusal::none); }
  void run_on() {
    image::Request on;
    on.kind = RequestKind::start;
    on.mode = static_cast<std::int8_t>(image::Mode::automatic);
    rig_.ask(on);
  }
  void act() {
    constexpr int kOverrides[] = {1, 10, 35, 70, 100, 100, 120, 150};
    if (rig_.state() == ProcessState::waiting) {
      if (rig_.status().mode != image::Mode::step) return;  // it runs on, and waits for no hand
      ++steps;
      if (random_() % 8 == 0) return run_on();
      return ask(RequestKind::step);
    }
    switch (random_() % 4) {
      case 0:
        rig_.logic.feed_override = kOverrides[random_() % std::size(kOverrides)];
        return;
      case 1:
        if (rig_.ask(RequestKind::hold) != Refusal::none) return;
        rig_.run(0.001 * static_cast<double>(random_() % 300));
        rig_.ask(RequestKind::resume);  // before it stands, often
        return;
      case 2:
        return hold_and_retrace();
      default:
        return;
    }
  }
  bool hold() {
    if (rig_.ask(RequestKind::hold) != Refusal::none) return false;
    // The block may end, and with it what can be held.
    return rig_.until([&] { return !rig_.moving() && rig_.state() != ProcessState::running; }, 20.0) &&
           rig_.state() == ProcessState::held;
  }
  void hold_and_retrace() {
    if (!hold()) return;
    ++held;
    rig_.run(0.02);
    for (int k = static_cast<int>(random_() % 3); k > 0; --k) {
      image::Request back;
      back.kind = RequestKind::retrace;
      if (random_() % 2 == 0)
        back.value = 0.01 * static_cast<double>(1 + random_() % 4000);
      else
        back.index = 1 + static_cast<std::uint32_t>(random_() % 20);
      if (rig_.ask(back) != Refusal::none) break;
      rig_.run(0.001 * static_cast<double>(random_() % 800));
      if (!rig_.status().retracing) continue;
      ask(RequestKind::hold);
      ASSERT_TRUE(rig_.until([&] { return !rig_.moving() && !rig_.status().retracing; }, 20.0))
          << "state " << static_cast<int>(rig_.state()) << " moving " << rig_.moving() << " at "
          << rig_.logic.feed_override << " %";
      rig_.run(0.02);
    }
    if (rig_.status().retraced) {
      ++retraced;
      // A way back that came to its end by itself may still settle.
      ASSERT_TRUE(rig_.until([&] { return !rig_.status().retracing && !rig_.moving(); }, 20.0));
      ask(RequestKind::reposition);
      ASSERT_TRUE(rig_.until([&] { return !rig_.status().retracing && !rig_.moving(); }, 200.0));
      rig_.run(0.02);
    }
    ask(RequestKind::resume);
  }

  Rig& rig_;
  std::mt19937_64& random_;
};

double to_segment(const Point& p, const Point& a, const Point& b) {
  double along = 0.0, square = 1e-30, off = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    square += (b[i] - a[i]) * (b[i] - a[i]);
  }
  const double s = std::clamp(along / square, 0.0, 1.0);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double d = a[i] + s * (b[i] - a[i]) - p[i];
    off += d * d;
  }
  return std::sqrt(off);
}

/// The largest distance of a point of one from the other.
double furthest(const std::vector<Point>& points, const std::vector<Point>& from) {
  double most = 0.0;
  for (const Point& p : points) {
    double least = 1e9;
    for (std::size_t k = 1; k < from.size() && least > most; ++k)
      least = std::min(least, to_segment(p, from[k - 1], from[k]));
    most = std::max(most, least);
  }
  return most;
}

std::vector<Point> where_it_moves(const std::vector<Point>& path) {
  std::vector<Point> out;
  for (const Point& p : path)
    if (out.empty() || p != out.back()) out.push_back(p);
  return out;
}

TEST(RandomUse, keeps_limits_and_tolerance_visits_the_whole_way_and_ends_in_its_end) {
  const char* given = std::getenv("SERVOGATE_PROPERTY_CASES");
  const std::uint64_t base = servogate::test::property_seed();
  const auto cases = static_cast<std::uint64_t>(given != nullptr ? std::atoi(given) : 6);
  int held = 0, retraced = 0, steps = 0;
  for (std::uint64_t seed = base; seed < base + cases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const Way way = Maker(random).make();
    Rig rig(way.program);
    Hands hands(rig, random);
    hands.work();
    ASSERT_TRUE(hands.finish()) << rig.alarm_list();
    EXPECT_EQ(rig.alarm_list(), "");
    EXPECT_EQ(rig.violations(), "");
    EXPECT_LE(std::hypot(rig.x(0) - way.points.back()[0], rig.x(1) - way.points.back()[1]), 1e-6);
    const std::vector<Point> driven = where_it_moves(rig.path);
    EXPECT_LE(furthest(driven, way.points), 0.0101) << "off the programmed path";
    EXPECT_LE(furthest(way.points, driven), 0.0101) << "left out of it";
    held += hands.held;
    retraced += hands.retraced;
    steps += hands.steps;
  }
  std::printf("%d holds, %d ways back, %d single blocks\n", held, retraced, steps);
}

}  // namespace
}  // namespace servogate::channel::test
