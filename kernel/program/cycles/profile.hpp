// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

namespace servogate::program {

class Execution;

/// A point or a direction of a profile: along the axis that it is cut along, in the direction of the work,
/// and out of the material; mm, of a diameter axis radii.
struct ProfileVector {
  double along = 0.0, out = 0.0;
};

struct ProfileCorner {
  enum class Kind { none, chamfer, round } kind = Kind::none;
  ProfileVector size;   ///< of a chamfer, no signs
  double radius = 0.0;  ///< of a round one
};

/// A groove or a step of up to three straight parts, with chamfers and fillets between them and at its ends.
struct Profile {
  std::string name;  ///< as the language writes it
  int along = 2, across = 0;
  double forward = 1.0, outward = 1.0;                  ///< signs of the two axes
  double begin_along = 0.0, begin_across = 0.0;         ///< programmed coordinates of the first point
  std::vector<ProfileVector> parts;                     ///< from point to point
  std::array<ProfileCorner, 4> corners{};               ///< at the points, as far as there are
  ProfileVector lead_in{1.0, 0.0}, lead_out{1.0, 0.0};  ///< directions of the surfaces beside it, of length 1
  double approach = 1.0;                                ///< before it the tool moves at rapid
  double step = 1.0;                                    ///< of one pass
  double allow_along = 0.0, allow_out = 0.0;            ///< left by the passes
  bool square = false;  ///< the tool enters a pass across, otherwise along the wall
  bool roughs = true, finishes = false;
  double feed = 0.0, last_feed = 0.0;  ///< 0: the one in force; the last pass is the finish
  double rpm = 0.0, last_rpm = 0.0;    ///< 0: the same
};

/// Passes in the direction of the work down to the allowance, without chamfers and with fillets as straight
/// lines; then the contour as a whole. Ends above the first point.
void turn_profile(Execution& run, const Profile& profile);

}  // namespace servogate::program
