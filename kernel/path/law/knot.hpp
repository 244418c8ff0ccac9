// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>

#include "kernel/path/shape/element.hpp"

namespace servogate::path {

/// A time that does not lose digits over a long run: whole nanoseconds and a rest.
struct LawTime {
  std::int64_t ns = 0;
  double fraction = 0.0;  ///< ns, 0 to below 1

  /// `seconds` later, >= 0. real-time safe.
  LawTime plus(double seconds) const noexcept {
    const double more = seconds * 1e9 + fraction, whole = std::floor(more);
    return {ns + static_cast<std::int64_t>(whole), more - whole};
  }
  /// The sum of two. real-time safe.
  LawTime plus(const LawTime& more) const noexcept {
    const double sum = fraction + more.fraction, whole = std::floor(sum);
    return {ns + more.ns + static_cast<std::int64_t>(whole), sum - whole};
  }
  /// Seconds since `earlier`. real-time safe.
  double since(const LawTime& earlier) const noexcept {
    return (static_cast<double>(ns - earlier.ns) + (fraction - earlier.fraction)) * 1e-9;
  }
};

/// How the curve's parameter, counted in knots, goes over time in one interval: a quintic with the given
/// rates and second derivatives at both ends, 0 to 1 in `seconds`. real-time safe.
struct Quintic {
  double seconds, c1, c2, c3, c4, c5;

  static Quintic between(double seconds, double w0, double a0, double w1, double a1) noexcept {
    const double v0 = w0 * seconds, v1 = w1 * seconds, b0 = a0 * seconds * seconds,
                 b1 = a1 * seconds * seconds;
    return {seconds,
            v0,
            0.5 * b0,
            10.0 - 6.0 * v0 - 4.0 * v1 - 1.5 * b0 + 0.5 * b1,
            -15.0 + 8.0 * v0 + 7.0 * v1 + 1.5 * b0 - b1,
            6.0 - 3.0 * v0 - 3.0 * v1 - 0.5 * b0 + 0.5 * b1};
  }
  /// At the share s of the time: value and derivatives by time.
  double at(double s) const noexcept { return s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))); }
  double d1(double s) const noexcept {
    return (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / seconds;
  }
  double d2(double s) const noexcept {
    return (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (seconds * seconds);
  }
  double d3(double s) const noexcept {
    return (6.0 * c3 + s * (24.0 * c4 + s * 60.0 * c5)) / (seconds * seconds * seconds);
  }
};

/// What is published of a run, knot by knot: final from the moment it is published. The set-point between
/// knots m - 1 and m is made of the controls of m - 3 to m; before the first knot of a run stand two
/// controls that are published with its begin.
struct Knot {
  enum class Kind : std::uint8_t {
    curve,     ///< the curve leads to it from the knot before
    guide,     ///< only its control counts: one of the two before the first knot of a run
    straight,  ///< a straight line at constant speed leads to it; `control` is its place
    join,      ///< first knot of a run behind a straight: that one, two guides, and this, all at one time
  };
  Kind kind = Kind::curve;
  LawTime t;             ///< law time since the start of the run
  double w = 0.0;        ///< knots a second at the knot
  double a = 0.0;        ///< knots a second, a second
  double place = 0.0;    ///< path parameter of the run that belongs to it
  double turns = 0.0;    ///< revolutions a second of the spindle that it is planned for; 0: feed per time
  double planned = 0.0;  ///< running sum of planned times, s; filled by the track
  Vector control{};      ///< of the curve, one to the front
};

/// The way between two knots. real-time safe.
class Stretch {
 public:
  /// `k`: the four knots whose last one ends the interval.
  explicit Stretch(const Knot* const (&k)[4]) noexcept
      : knots_{k[0], k[1], k[2], k[3]},
        tau_(Quintic::between(k[3]->t.since(k[2]->t), k[2]->w, k[2]->a, k[3]->w, k[3]->a)) {}
  double seconds() const noexcept { return tau_.seconds; }
  /// Position `t` seconds behind the interval's start, over the first `axes`.
  Vector position(double t, int axes) const noexcept;

 private:
  const Knot* knots_[4];
  Quintic tau_;
};

}  // namespace servogate::path
