// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"

/// What the motions of a program cut, by geometry that knows nothing of cycles: the material that stands over
/// a line of places, and the holes that go down from it.
namespace servogate::program::tests {

/// One motion of a program.
struct Way {
  Position from{}, to{};
  enum class Kind { rapid, cut, thread } kind = Kind::rapid;
  int line = 0;
};

/// All motions but the first, which comes from wherever the axes stand; a failed test where the program has
/// an error. Arcs are taken as chords of half a degree.
std::vector<Way> ways_of(const std::string& dialect, const MachineModel& machine, const std::string& program);

/// A machine of linear axes with letters like "XZ"; X of `turns` is a diameter, in `travel` mm to both sides.
MachineModel machine_of(const std::string& letters, bool turns, double travel = 500.0);

/// Three decimals.
std::string digits(double value);

/// A motion in the plane of the work: `a` along the surface, `r` out of the material.
struct Stroke {
  double a0 = 0.0, r0 = 0.0, a1 = 0.0, r1 = 0.0;
  bool cuts = false;
};
/// Of two axes by their indices.
std::vector<Stroke> strokes(const std::vector<Way>& ways, std::size_t along, std::size_t out);

/// A contour of straight parts from place to place; `a` never turns back.
class Outline {
 public:
  explicit Outline(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {}
  double lowest(double a) const { return extreme(a, kNear, false); }  ///< near `a`; 1e9 beside the contour
  /// No farther from `a` than this; -1e9 beside the contour.
  double highest(double a, double near = kNear) const { return extreme(a, near, true); }
  Outline shifted(double along, double out) const;
  double first() const;
  double last() const;

 private:
  static constexpr double kNear = 1e-3;  ///< mm
  double extreme(double a, double near, bool highest) const;
  std::vector<std::pair<double, double>> points_;  ///< a, r
};

/// What stands of the blank over a grid of places.
class Stock {
 public:
  Stock(double from, double to, const std::function<double(double)>& blank);
  /// Takes a stroke away. "" or what was wrong: at rapid through material, or a cut below `floor`.
  std::string take(const Stroke& stroke, const std::function<double(double)>& floor);
  double height(double a) const;
  const std::vector<double>& heights() const { return heights_; }
  double place(std::size_t n) const { return from_ + static_cast<double>(n) * kGrid; }
  static constexpr double kGrid = 0.02;  ///< mm

 private:
  double from_;
  std::vector<double> heights_;
};

/// Holes and grooves that go down from a surface at places across.
class Holes {
 public:
  /// Nothing stands above `surface`; at most `step` is cut in one go; below the surface the tool moves across
  /// by at most `relief`.
  Holes(double surface, double step, double relief = 0.0) : surface_(surface), step_(step), relief_(relief) {}
  std::string take(const Stroke& stroke);
  /// Bottom at each place that was cut.
  std::map<double, double> bottoms() const;

 private:
  double surface_, step_, relief_;
  std::map<long long, double> bottoms_;  ///< by the place in 0.1 um
};

}  // namespace servogate::program::tests
