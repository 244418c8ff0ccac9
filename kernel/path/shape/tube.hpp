// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/path/shape/element.hpp"

namespace servogate::path {

/// Weights of the four controls of an interval of a uniform cubic B-spline at its share f, 0 - 1. real-time
/// safe.
inline std::array<double, 4> spline_weights(double f) noexcept {
  const double g = 1.0 - f, a = g * g * g / 6.0, d = f * f * f / 6.0;
  const double b = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0;
  return {a, b, 1.0 - a - b - d, d};
}

/// A place of the curve that must lie near a place of the programmed path.
struct Site {
  std::int32_t interval = 0;  ///< the curve is made of controls `interval` to `interval` + 3 there
  double share = 0.0;         ///< of the interval
  Vector at{};                ///< place of the programmed path, axis by axis of the problem
  double radius = 0.0;        ///< largest distance, > 0
  Vector along{};             ///< a unit vector in which the distance may be `slide`, or zero
  double slide = 0.0;
  double pull = 0.0;  ///< the square of distance by this length counts a little in the objective
  /// Square of the largest distance that is asked for, as a ratio of `radius`, below or at 1. Larger on
  /// return where the curve could not be brought in ("released").
  double limit = 1.0;
};

/// A curve inside a tube: a uniform cubic B-spline over its parameter whose third derivative is small and
/// flat.
struct TubeProblem {
  int axes = 0;                     ///< 1 - kMaxAxes; all arrays below hold so many values a place
  std::vector<double> controls;     ///< start, then solution
  std::vector<double> jerk;         ///< for each interval: third difference of controls that counts as 1
  std::vector<Site> sites;          ///< along the curve
  std::size_t first = 0, last = 0;  ///< controls that may move; those outside are given
  bool flat = false;  ///< peaks of the third derivative count by their eighth power, else square
  std::size_t count() const { return controls.size() / static_cast<std::size_t>(axes); }
};

struct TubeSolution {
  bool inside = false;  ///< every site keeps what was asked of it
  int released = 0;     ///< sites that do not
  int steps = 0;        ///< of Newton's method, for benchmarks
};

/// Solves TubeProblem by logarithmic barrier and Newton's method with bounded numbers of steps. The start may
/// lie outside; sites that cannot be brought in are released, all others hold. Keeps its working memory, and
/// nothing else. Not real-time safe.
class Tube {
 public:
  Tube();
  ~Tube();
  TubeSolution solve(TubeProblem& problem);

  class Solver {
   public:
    virtual ~Solver() = default;
    virtual TubeSolution solve(TubeProblem& problem) = 0;
  };

 private:
  std::array<std::unique_ptr<Solver>, kMaxAxes> by_axes_;
};

}  // namespace servogate::path
