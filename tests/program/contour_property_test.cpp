// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"
#include "tests/program/case_file.hpp"
#include "tests/property_seed.hpp"

/// Radius compensation judged by what a tool does to a part: distances of points from lines and arcs, and
/// nothing of the code that shifts contours.
namespace servogate::program::tests {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kContours = 600;
constexpr double kCut = 2e-5;      ///< mm that the tool may enter the part by rounding
constexpr double kTouches = 2e-4;  ///< mm that it may stay away where it can reach

struct Spot {
  double x, y;
};
double far(Spot a, Spot b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// A line, or an arc whose centre lies `side` (+1 left) of the way from a to b.
struct Edge {
  Spot a, b;
  double radius = 0.0;  ///< of an arc, 0: a line
  int side = 0;
  Spot centre() const {
    const double chord = far(a, b), height = std::sqrt(radius * radius - chord * chord / 4.0);
    const double nx = -(b.y - a.y) / chord, ny = (b.x - a.x) / chord;
    return {(a.x + b.x) / 2.0 + side * height * nx, (a.y + b.y) / 2.0 + side * height * ny};
  }
  double turn() const { return side * 2.0 * std::asin(far(a, b) / (2.0 * radius)); }
  Spot at(double share) const {
    if (radius == 0.0) return {a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share};
    const Spot c = centre();
    const double angle = std::atan2(a.y - c.y, a.x - c.x) + turn() * share;
    return {c.x + radius * std::cos(angle), c.y + radius * std::sin(angle)};
  }
  /// Unit vector to the left of the way at a share of it.
  Spot left(double share) const {
    if (radius == 0.0) return {-(b.y - a.y) / far(a, b), (b.x - a.x) / far(a, b)};
    const Spot c = centre(), p = at(share);
    return {side * (c.x - p.x) / radius, side * (c.y - p.y) / radius};
  }
  double distance(Spot p) const {
    double nearest = std::min(far(p, a), far(p, b));
    if (radius == 0.0) {
      const double way = far(a, b);
      const double along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / (way * way);
      return along > 0.0 && along < 1.0 ? std::min(nearest, far(p, at(along))) : nearest;
    }
    const Spot c = centre();
    double angle = std::atan2(p.y - c.y, p.x - c.x) - std::atan2(a.y - c.y, a.x - c.x);
    while (angle * side < 0.0) angle += side * 2.0 * kPi;
    while (angle * side > 2.0 * kPi) angle -= side * 2.0 * kPi;
    return std::abs(angle) < std::abs(turn()) ? std::min(nearest, std::abs(far(p, c) - radius)) : nearest;
  }
};

/// A closed contour around the zero point, counter-clockwise, that begins in the middle of a line.
std::vector<Edge> draw(std::mt19937_64& random) {
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  const int corners = std::uniform_int_distribution<>(4, 9)(random);
  std::vector<Spot> spots;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * kPi * (i + number(-0.2, 0.2)) / corners, out = number(40.0, 60.0);
    // As a program writes them.
    spots.push_back(
        {std::round(out * std::cos(angle) * 1e4) / 1e4, std::round(out * std::sin(angle) * 1e4) / 1e4});
  }
  std::vector<Edge> edges;
  for (int i = 0; i < corners; ++i) {
    Edge edge{spots[static_cast<std::size_t>(i)], spots[static_cast<std::size_t>((i + 1) % corners)]};
    if (i > 0 && number(0.0, 1.0) < 0.5) {
      edge.radius = std::round(far(edge.a, edge.b) * number(1.2, 4.0) * 1e4) / 1e4;
      edge.side = number(0.0, 1.0) < 0.5 ? 1 : -1;
    }
    edges.push_back(edge);
  }
  Edge& first = edges.front();
  const Spot start{std::round(first.at(0.5).x * 1e4) / 1e4, std::round(first.at(0.5).y * 1e4) / 1e4};
  Edge last{first.a, start};
  first.a = start;
  edges.push_back(last);
  return edges;
}

std::string place(Spot p) {
  char text[64];
  std::snprintf(text, sizeof text, "X%.4f Y%.4f", p.x, p.y);
  return text;
}

std::string program_of(const std::vector<Edge>& edges, bool left, bool rolled) {
  std::string text =
      "T1.1 M6\nF500\nG0 X0 Y0\nG1 " + std::string(left ? "G41 " : "G42 ") + place(edges.front().a) + "\n";
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& edge = edges[i];
    if (rolled && i > 0) text += "r0\n";
    const std::string off = i + 1 == edges.size() ? "G40 " : "";
    char radius[32];
    std::snprintf(radius, sizeof radius, " R%.4f", edge.radius);
    text += edge.radius == 0.0 ? "G1 " + off + place(edge.b) + "\n"
                               : (edge.side > 0 ? "G3 " : "G2 ") + off + place(edge.b) + radius + "\n";
  }
  return text;
}

/// The way of the tool's centre behind the approach, as points not further apart than `step`.
struct Way {
  std::vector<Spot> points;
  std::string error;
};
Way drive(const std::string& program, double radius, double step) {
  MachineModel machine = mill();
  Tables tables;
  tables.correctors[1].radius = radius;
  Interpreter run("nc110", machine, tables, "p.nc", program, {}, Position{});
  const image::Packets packets;
  Way way;
  Spot stands{};
  int motions = 0;
  for (;;) {
    const Step next = run.next(packets, true);
    if (const auto* error = std::get_if<Error>(&next)) {
      way.error = error->finding.str();
      return way;
    }
    if (std::holds_alternative<NeedsSync>(next)) continue;
    const Command& command = std::get<Command>(next);
    if (std::holds_alternative<End>(command.what)) return way;
    const auto go = [&](const Position& to, auto at, double length) {
      ++motions;
      const int parts = static_cast<int>(length / step) + 1;
      if (motions > 2)
        for (int i = 0; i <= parts; ++i) way.points.push_back(at(static_cast<double>(i) / parts));
      stands = {to[0], to[1]};
    };
    const Spot from = stands;
    if (const auto* line = std::get_if<Line>(&command.what)) {
      const Spot to{line->to[0], line->to[1]};
      go(
          line->to,
          [&](double s) {
            return Spot{from.x + (to.x - from.x) * s, from.y + (to.y - from.y) * s};
          },
          far(from, to));
    } else if (const auto* rapid = std::get_if<Rapid>(&command.what)) {
      go(
          rapid->to, [&](double) { return from; }, 0.0);
    } else if (const auto* arc = std::get_if<Arc>(&command.what)) {
      const double r = far(from, {arc->center1, arc->center2}), turn = arc->sweep_deg * kPi / 180.0;
      const double begin = std::atan2(from.y - arc->center2, from.x - arc->center1);
      go(
          arc->to,
          [&](double s) {
            return Spot{arc->center1 + r * std::cos(begin + turn * s),
                        arc->center2 + r * std::sin(begin + turn * s)};
          },
          std::abs(turn) * r);
    }
  }
}

double distance(const std::vector<Edge>& edges, Spot p) {
  double nearest = 1e9;
  for (const Edge& edge : edges) nearest = std::min(nearest, edge.distance(p));
  return nearest;
}

/// Distance of a point from the way that its points stand for.
double distance(const Way& way, Spot p) {
  double nearest = 1e9;
  for (std::size_t i = 0; i + 1 < way.points.size(); ++i) {
    const Edge part{way.points[i], way.points[i + 1]};
    if (far(part.a, part.b) > 1e-12) nearest = std::min(nearest, part.distance(p));
  }
  return nearest;
}

TEST(Contour, of_random_lines_and_arcs_is_touched_everywhere_where_the_tool_can_and_never_cut_into) {
  std::mt19937_64 random(servogate::test::property_seed());
  int refused = 0;
  for (int i = 0; i < kContours && !HasFailure(); ++i) {
    const std::vector<Edge> edges = draw(random);
    const double radius = std::uniform_real_distribution<>(0.5, 4.0)(random);
    const bool left = random() % 2 == 0, rolled = random() % 3 == 0;
    const std::string program = program_of(edges, left, rolled);
    const Way way = drive(program, radius, 0.2);
    if (!way.error.empty()) {
      EXPECT_NE(std::string::npos, way.error.find("not congruent")) << way.error << "\n" << program;
      ++refused;
      continue;
    }
    for (const Spot& p : way.points)
      EXPECT_GE(distance(edges, p), radius - kCut) << "radius " << radius << " at " << place(p) << "\n"
                                                   << program;
    for (const Edge& edge : edges)
      for (double share = 0.05; share < 1.0; share += 0.1) {
        const Spot on = edge.at(share), out = edge.left(share);
        const double side = left ? radius : -radius;
        const Spot centre{on.x + side * out.x, on.y + side * out.y};
        if (distance(edges, centre) < radius - kCut) continue;  // the tool does not reach there
        // Chords of a tenth of a millimetre on arcs of some millimetres.
        EXPECT_LE(distance(way, centre), kTouches + 0.2 * 0.2 / (8.0 * radius))
            << "radius " << radius << " at " << place(on) << "\n"
            << program;
      }
  }
  EXPECT_LT(refused, kContours / 20);
}

}  // namespace
}  // namespace servogate::program::tests
