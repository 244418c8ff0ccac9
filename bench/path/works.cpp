// SPDX-License-Identifier: Apache-2.0
#include "bench/path/works.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace servogate::bench {

using path::Config;
using path::Continuation;
using path::Element;

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Element line(double x, double y, double z, double feed_mm_min) {
  Element e;
  e.to = {x, y, z};
  e.feed = feed_mm_min / 60.0;
  e.transition = {Continuation::continuous, 0.01, 0.0, 180.0, false};
  return e;
}

}  // namespace

Config machine(double acceleration, double jerk) {
  Config config;
  for (int i = 0; i < 3; ++i) config.limits[i] = {500.0, acceleration, jerk};
  return config;
}

Program polygon(double radius, int blocks, double step_angle, double feed) {
  Program p;
  for (int i = 1; i <= blocks; ++i)
    p.push_back(
        line(radius - radius * std::cos(step_angle * i), radius * std::sin(step_angle * i), 0.0, feed));
  return p;
}

Program circle(double radius, double feed) {
  Element e = line(0, 0, 0, feed);
  e.kind = Element::Kind::arc;
  e.center1 = radius;
  e.sweep_deg = 360.0;
  return {e};
}

Program collinear(int blocks, double step, double feed) {
  Program p;
  for (int i = 1; i <= blocks; ++i) p.push_back(line(step * i, 0, 0, feed));
  return p;
}

Program zigzag(int blocks, double step, double feed) {
  Program p;
  for (int i = 1; i <= blocks; ++i) p.push_back(line(step * ((i + 1) / 2), step * (i / 2), 0, feed));
  return p;
}

/// Heading a random walk of 0.03 rad a block in plan and 0.01 in elevation, kept inside 95 mm.
Program random_walk(int blocks, double feed) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> plan(0.0, 0.03), elevation(0.0, 0.01);
  std::uniform_real_distribution<double> length(0.1, 0.5);
  Program p;
  double x = 0, y = 0, z = 0, heading = 0, climb = 0;
  for (int i = 0; i < blocks; ++i) {
    heading += plan(random);
    climb = std::clamp(climb + elevation(random), -0.5, 0.5);
    const double l = length(random), to_center = std::atan2(-y, -x);
    if (std::hypot(x, y) > 75.0) heading += 0.05 * std::sin(to_center - heading);
    if (std::abs(z) > 75.0) climb -= 0.02 * std::copysign(1.0, z);
    x += l * std::cos(climb) * std::cos(heading);
    y += l * std::cos(climb) * std::sin(heading);
    z += l * std::sin(climb);
    p.push_back(line(x, y, z, feed));
  }
  return p;
}

Program surface_rows(double feed) {
  Program p;
  constexpr double kWidth = 40.0, kChord = 0.05, kRow = 0.5;
  const auto height = [](double x, double y) {
    return 3.0 * std::sin(0.3 * x) * std::cos(0.2 * y) + 0.4 * std::sin(1.1 * x + 0.5 * y);
  };
  for (int row = 0; row < 12; ++row) {
    const double y = row * kRow;
    const int chords = static_cast<int>(kWidth / kChord);
    for (int k = 0; k <= chords; ++k) {
      const double x = row % 2 == 0 ? k * kChord : kWidth - k * kChord;
      p.push_back(line(x, y, height(x, y) - height(0, 0), feed));
    }
  }
  p.erase(p.begin());  // the start itself
  return p;
}

Program trochoids(double feed) {
  Program p;
  constexpr double kRadius = 2.0, kStep = 0.4;
  constexpr int kLoops = 40, kChords = 90;
  for (int k = 1; k <= kLoops * kChords; ++k) {
    const double angle = kTurn * k / kChords;
    p.push_back(
        line(kStep * k / kChords + kRadius * std::sin(angle), kRadius * (1.0 - std::cos(angle)), 0.0, feed));
  }
  return p;
}

Program engraving(double feed) {
  // Strokes of a letter, as shares of its width and height; the next letter begins where it ends.
  constexpr double kStrokes[][2] = {{0, 1}, {0.5, 0.4}, {1, 1},      {1, 0},      {1.3, 0},    {1.3, 1},
                                    {2, 1}, {2, 0.5},   {1.35, 0.5}, {2.1, 0.45}, {2.2, 0},    {2.6, 0.9},
                                    {3, 0}, {2.8, 0.4}, {2.4, 0.4},  {2.4, -0.2}, {3.2, -0.2}, {3.2, 0}};
  Program p;
  for (int letter = 0; letter < 25; ++letter)
    for (const auto& stroke : kStrokes)
      p.push_back(line(2.0 * (3.2 * letter + stroke[0]), 3.0 * stroke[1], 0.0, feed));
  return p;
}

Program thread_helix(double feed) {
  Program p;
  constexpr double kRadius = 6.0, kPitch = 1.5;
  constexpr int kTurns = 12, kChords = 380;
  for (int k = 1; k <= kTurns * kChords; ++k) {
    const double angle = kTurn * k / kChords;
    p.push_back(
        line(kRadius * (1.0 - std::cos(angle)), kRadius * std::sin(angle), kPitch * k / kChords, feed));
  }
  return p;
}

Program pocket(double feed) {
  Program p;
  double x = 0, y = 0;
  for (int k = 0; k < 10; ++k) {
    const double a = 60 - 4 * k, b = 40 - 3 * k;
    for (const auto& [dx, dy] : {std::pair{a, 0.0}, {a, b}, {2.0, b}, {2.0, 2.0}})
      p.push_back(line(x + dx, y + dy, 0, feed));
    x += 2, y += 2;
  }
  return p;
}

Program impeller(double feed) {
  Program p;
  constexpr int kRows = 10, kPoints = 500;
  const auto at = [](double u, double v) {
    const double angle = 1.4 * u * u + 0.1 * v, radius = 15.0 + 30.0 * u;
    return path::Vector{radius * std::cos(angle), radius * std::sin(angle),
                        -20.0 * u * (1.0 - 0.5 * u) + 5.0 * v * (1.0 - u)};
  };
  const path::Vector start = at(0.0, 0.0);
  for (int row = 0; row < kRows; ++row)
    for (int k = row == 0 ? 1 : 0; k <= kPoints; ++k) {
      const double share = static_cast<double>(k) / kPoints, u = row % 2 == 0 ? share : 1.0 - share;
      // Denser where the blade bends most, at its outer end.
      const path::Vector x = at(std::sqrt(u) * (2.0 - std::sqrt(u)), 0.3 * row);
      p.push_back(line(x[0] - start[0], x[1] - start[1], x[2] - start[2], feed));
    }
  return p;
}

}  // namespace servogate::bench
