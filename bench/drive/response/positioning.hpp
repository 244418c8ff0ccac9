// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

/// How exactly an axis positions. Pure functions; not real-time safe.
namespace servogate::bench {

/// One approach of one target, in any one unit of length or angle.
struct Approach {
  double target = 0.0, actual = 0.0;
  bool positive = true;  ///< it came in positive direction
};

/// Figures of ISO 230-2:2014 by their symbols, in the unit of the approaches. Uni-directional ones are of the
/// worse direction.
struct Positioning {
  struct Target {
    double target = 0.0;
    double mean_up = 0.0, mean_down = 0.0;      ///< mean deviation, actual less target
    double repeat_up = 0.0, repeat_down = 0.0;  ///< R: four standard deviations
    double reversal = 0.0;                      ///< B: mean up less mean down
  };
  std::vector<Target> targets;  ///< by rising place
  double reversal = 0.0;        ///< B: the greatest of a target, as a magnitude
  double mean_reversal = 0.0;   ///< of all targets, with its sign
  double repeatability_up = 0.0, repeatability_down = 0.0;
  double repeatability = 0.0;       ///< R, bi-directional: of a target with its reversal
  double systematic = 0.0;          ///< E, bi-directional systematic error
  double mean_bidirectional = 0.0;  ///< M: range of the means of both directions
  double accuracy = 0.0;            ///< A, bi-directional: systematic error with scatter
};
/// Each target needs at least two approaches in each direction (the standard asks for five); nullopt: one has
/// fewer, or there is none.
std::optional<Positioning> positioning(std::span<const Approach> approaches);

/// Figures of a circular path of two axes by their symbols in ISO 230-4:2005, in the unit of the path.
struct Circularity {
  double centre_x = 0.0, centre_y = 0.0;  ///< of the least-squares circle
  double radius = 0.0;                    ///< its own
  double deviation = 0.0;                 ///< G: greatest less least radius about that centre
  double greatest = 0.0, least = 0.0;     ///< F max and F min: radial deviation from the nominal radius
};
/// The measured path in its order. nullopt: fewer than eight points, or no circle lies near them.
std::optional<Circularity> circularity(std::span<const double> x, std::span<const double> y,
                                       double nominal_radius);

/// G(b) of both directions: the range of radii of both paths about one centre, and H, the hysteresis: the
/// greatest difference of their radii at one angle.
struct CircleReversal {
  double bidirectional = 0.0, hysteresis = 0.0;
};
std::optional<CircleReversal> circle_reversal(std::span<const double> x_one, std::span<const double> y_one,
                                              std::span<const double> x_other,
                                              std::span<const double> y_other);

}  // namespace servogate::bench
