// SPDX-License-Identifier: Apache-2.0
// Grooves and steps of Fenix (G853, G855) against geometry of their own: what stands of the material, what
// the tool cuts and where it goes at rapid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"
#include "tests/program/cut_judge.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program {
namespace {

using tests::Stock;

struct Point2 {
  double a = 0.0, r = 0.0;
};

constexpr double kEdge = 1e-5;  ///< programs have six digits

struct Move {
  Point2 from, to;
  bool rapid = false;
};

/// A groove or step in the coordinates of its work: (0, 0) is its begin, `a` the way of the work, `r` out of
/// the material. No chamfers.
struct Groove {
  bool along_z = true;
  int mode = 0;  ///< P0 of G852
  std::vector<Point2> points;
  double step = 1.0, allow_along = 0.0, allow_out = 0.0, approach = 1.0;
  bool square = false;
  bool open_left() const { return points.back().r > 1e-9 && points[1].r >= -1e-9; }
  bool open_right() const { return points.back().r < -1e-9; }

  /// Lowest place of the contour at `a`: what must stand.
  double bottom(double a) const {
    if (a < points.front().a - kEdge) return open_left() ? -1e9 : 0.0;
    if (a > points.back().a + kEdge) return open_right() ? -1e9 : points.back().r;
    double out = -1e9;
    for (std::size_t n = 0; n + 1 < points.size(); ++n) {
      const Point2 &p = points[n], &q = points[n + 1];
      if (a < p.a - kEdge || a > q.a + kEdge) continue;
      const double s = q.a - p.a < kEdge ? 0.0 : (a - p.a) / (q.a - p.a);
      const double here = q.a - p.a < kEdge ? std::min(p.r, q.r) : p.r + s * (q.r - p.r);
      out = std::max(out, here);
    }
    return out;
  }
  double top() const { return std::max(0.0, points.back().r); }
};

std::string number(double value) { return std::to_string(value); }

/// Positive sizes of the three parts along and across, the sign of the second one across.
std::string program_of(const Groove& g, const Point2 (&parts)[3], int work) {
  const auto sizes = [&](const Point2& part, bool sign) {
    const double outward = g.mode < 2 ? 1.0 : -1.0;
    const double out = sign ? outward * part.r : std::abs(part.r);
    return g.along_z ? number(part.a) + "," + number(out) : number(out) + "," + number(part.a);
  };
  std::string text = "%\nN1 G90 G26 G94 F1000\nN2 G852(" + std::to_string(g.mode);
  for (int n = 0; n < 3; ++n) text += "," + sizes(parts[n], n == 1) + ",";
  const double z = g.along_z ? g.allow_along : g.allow_out, x = g.along_z ? g.allow_out : g.allow_along;
  text += ")\nN3 " + std::string(g.along_z ? "G853(" : "G855(") + "0,100," + number(g.approach) + "," +
          number(g.step) + "," + number(z) + "," + number(x) + ",0," + std::to_string(work) + "," +
          (g.square ? "1" : "0") + ")\n";
  return text;
}

/// The motions of the cycle in its coordinates.
std::vector<Move> moves_of(const Groove& g, const std::string& text) {
  MachineModel model;
  for (const char* letter : {"X", "Z"}) {
    MachineModel::Axis axis;
    axis.letter = letter;
    axis.diameter = letter[0] == 'X';
    axis.travel_min = -500.0;
    axis.travel_max = 500.0;
    model.axes.push_back(axis);
  }
  Interpreter run("fenix", model, {}, "p.nc", text, {}, {}, 0);
  const double forward = g.mode == 0 || g.mode == 2 ? -1.0 : 1.0, outward = g.mode < 2 ? 1.0 : -1.0;
  const auto local = [&](const Position& p) {
    const double z = p[1], x = p[0] - 100.0;
    return Point2{forward * (g.along_z ? z : x), outward * (g.along_z ? x : z)};
  };
  std::vector<Move> moves;
  Point2 at;
  bool begun = false;
  const image::Packets packets;
  for (;;) {
    const Step step = run.next(packets, true);
    if (const auto* error = std::get_if<Error>(&step)) {
      ADD_FAILURE() << error->finding.str() << "\n" << text;
      return moves;
    }
    const auto* command = std::get_if<Command>(&step);
    if (command == nullptr) continue;
    if (std::holds_alternative<End>(command->what)) return moves;
    const auto* rapid = std::get_if<Rapid>(&command->what);
    const auto* line = std::get_if<Line>(&command->what);
    if (rapid == nullptr && line == nullptr) continue;
    const Point2 to = local(rapid != nullptr ? rapid->to : line->to);
    if (begun) moves.push_back({at, to, rapid != nullptr});
    begun = true;  // the first one comes from outside
    at = to;
  }
}

constexpr int kCases = 200;
constexpr double kGrid = Stock::kGrid, kLeft = -5.0;

/// What stands before: the body beside what is worked, nothing where the work is open.
Stock blank_of(const Groove& g) {
  return Stock(kLeft, g.points.back().a + 5.0, [&g](double a) {
    const bool free = (a < 0.0 && g.open_left()) || (a > g.points.back().a && g.open_right());
    const bool beside = a < 0.0 || a > g.points.back().a;
    return free ? -1e9 : beside ? g.bottom(a) : g.top();
  });
}

/// The motion takes away what it may: the contour and its allowances stand.
std::string take(Stock& stock, const Groove& g, const Move& move, double raised_along, double raised_out) {
  return stock.take({move.from.a, move.from.r, move.to.a, move.to.r, !move.rapid}, [&](double a) {
    double must = -1e9;
    for (const double shift : {-raised_along, 0.0, raised_along}) must = std::max(must, g.bottom(a + shift));
    return must < -1e8 ? 1e9 : must + raised_out;
  });
}

TEST(Groove, of_random_shapes_is_cut_whole_and_nothing_else_is) {
  std::mt19937_64 random(test::property_seed());
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < kCases; ++round) {
    Groove g;
    g.along_z = random() % 2 == 0;
    g.mode = static_cast<int>(random() % 4);
    g.square = random() % 2 == 0;
    g.step = real(0.3, 2.0);
    g.allow_along = real(0.0, 0.6);
    g.allow_out = real(0.0, 0.6);
    g.approach = real(0.5, 2.0);
    Point2 parts[3] = {{random() % 2 == 0 ? 0.0 : real(0.2, 4.0), -real(3.0, 8.0)},
                       {real(4.0, 15.0), random() % 2 == 0 ? 0.0 : real(-1.5, 1.5)},
                       {random() % 2 == 0 ? 0.0 : real(0.2, 4.0), real(3.0, 8.0)}};
    const int kind = static_cast<int>(random() % 3);
    if (kind == 1) parts[0] = {0.0, 0.0}, parts[1].r = std::abs(parts[1].r);
    if (kind == 2) parts[2] = {0.0, 0.0}, parts[1].r = -std::abs(parts[1].r);
    g.points.push_back({});
    for (const Point2& part : parts)
      if (part.a != 0.0 || part.r != 0.0)
        g.points.push_back({g.points.back().a + part.a, g.points.back().r + part.r});

    Stock stock = blank_of(g);
    const std::string rough = program_of(g, parts, 0);
    for (const Move& move : moves_of(g, rough))
      ASSERT_EQ(take(stock, g, move, g.allow_along, g.allow_out), "") << rough;
    // No more stands than a step over the allowance, wherever a pass is wide enough to go.
    const double steepest = 40.0;
    for (double a = g.allow_along + 0.1; a < g.points.back().a - g.allow_along - 0.1; a += 0.05) {
      double must = g.bottom(a);
      for (double shift = -g.allow_along - 0.1; shift <= g.allow_along + 0.1; shift += 0.02)
        must = std::max(must, g.bottom(a + shift));
      EXPECT_LE(stock.height(a), must + g.allow_out + g.step + steepest * kGrid + 1e-6) << a << "\n" << rough;
    }
    const std::string finish = program_of(g, parts, 2);
    for (const Move& move : moves_of(g, finish)) ASSERT_EQ(take(stock, g, move, 0.0, 0.0), "") << finish;
    for (double a = 0.1; a < g.points.back().a - 0.1; a += 0.05) {
      double highest = -1e9, lowest = 1e9;
      for (double near = -2.0 * kGrid; near <= 2.0 * kGrid; near += kGrid / 2.0)
        highest = std::max(highest, g.bottom(a + near)), lowest = std::min(lowest, g.bottom(a + near));
      EXPECT_LE(stock.height(a), highest + kEdge) << a << "\n" << finish;
      EXPECT_GE(stock.height(a), lowest - kEdge) << a << "\n" << finish;
    }
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace servogate::program
