// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/profile.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// G851, G852, G853 and G855 (specification 21).
namespace servogate::program::fenix {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLongest = 99'999.999;
constexpr int kCorners = 4, kCornerArguments = 16, kContourArguments = 12, kCycleArguments = 13;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
std::size_t at(Own own) { return static_cast<std::size_t>(own); }
bool given(double value) { return !std::isnan(value); }

/// Z and X of a part, in this order; X as a radius.
struct Sizes {
  double z = 0.0, x = 0.0;
};

/// What G851 and G852 have stored.
class Stored {
 public:
  Stored(const Execution& run, std::string name, int column)
      : run_(run), name_(std::move(name)), column_(column) {}
  double corner(int n) const { return run_.state().own[at(Own::corners) + static_cast<std::size_t>(n)]; }
  double contour(int n) const { return run_.state().own[at(Own::contour) + static_cast<std::size_t>(n)]; }
  bool has_contour() const { return run_.state().own[at(Own::contour_set)] != 0.0; }
  bool has_corners() const { return run_.state().own[at(Own::corners_set)] != 0.0; }

  /// Both from one of them and the angle, where only one is given.
  Sizes sizes(double z, double x, double angle, const char* angle_name) const {
    if (!given(z) && !given(x)) return {};
    if (given(x)) x = across(x);
    if (!given(angle)) return {given(z) ? z : 0.0, given(x) ? x : 0.0};
    const double slope = std::abs(std::tan(angle * kDegree));
    if (!given(x)) x = std::abs(z) * slope;
    if (!given(z)) z = std::abs(x) / slope;
    if (!(std::abs(x) <= kLongest && std::abs(z) <= kLongest))
      fail(Wrong::argument_slope, column_, {name_, angle_name, text::number(angle)});
    return {z, x};
  }
  /// As words of X count at this place.
  double across(double x) const {
    const int axis = run_.state().frames.axis2;
    const bool diameter =
        run_.machine().axes[at(axis)].diameter && run_.state().modes.across == Function::diameter;
    return diameter ? x / 2.0 : x;
  }

 private:
  const Execution& run_;
  std::string name_;
  int column_;
};

/// The arguments as they stand, a gap as one.
void store(Execution& run, const BlockWords& words, Own first, Own flag, int most) {
  const Arguments arguments(run, words);
  run.refuse_all_but(words, {});
  arguments.at_most(most);
  for (int n = 0; n < most; ++n)
    run.state().own[at(first) + static_cast<std::size_t>(n)] =
        arguments.given(n) ? arguments.number(n) : kNone;
  run.state().own[at(flag)] = 1.0;
}

/// Along the main axis and the other one, whose names change places in G855.
ProfileVector turned(Sizes sizes, bool along_z) {
  return along_z ? ProfileVector{sizes.z, sizes.x} : ProfileVector{sizes.x, sizes.z};
}

ProfileCorner corner_of(const Stored& stored, int n, bool along_z) {
  using Kind = ProfileCorner::Kind;
  ProfileCorner corner;
  const double type = stored.corner(4 * n), size = stored.corner(4 * n + 1);
  if (given(type) && type == 2.0) return corner;
  if (given(type) && type == 1.0) {
    corner.radius = given(size) ? std::abs(size) : 0.0;
    if (corner.radius > 0.0) corner.kind = Kind::round;
    return corner;
  }
  const Sizes sizes = stored.sizes(size, stored.corner(4 * n + 2), stored.corner(4 * n + 3), "3");
  corner.size = turned({std::abs(sizes.z), std::abs(sizes.x)}, along_z);
  corner.kind = Kind::chamfer;
  return corner;
}

/// Those that are left out are chamfers with the projections of the first one.
void take_corners(const Stored& stored, bool along_z, Profile& profile) {
  if (!stored.has_corners()) return;
  bool others = false;
  for (int n = 4; n < kCornerArguments; ++n) others = others || given(stored.corner(n));
  for (int n = 0; n < kCorners; ++n)
    if (others || n == 0) profile.corners[static_cast<std::size_t>(n)] = corner_of(stored, n, along_z);
  if (others) return;
  ProfileCorner like = profile.corners[0];
  if (like.kind == ProfileCorner::Kind::round)
    like = {ProfileCorner::Kind::chamfer, {like.radius, like.radius}, 0.0};
  for (std::size_t n = 1; n < kCorners; ++n) profile.corners[n] = like;
}

/// A surface beside the contour, by its angle from the positive main axis.
ProfileVector surface(double angle, const Profile& profile) {
  if (!given(angle)) return {1.0, 0.0};
  return {profile.forward * std::cos(angle * kDegree), profile.outward * std::sin(angle * kDegree)};
}

void take_contour(const Stored& stored, bool along_z, int column, Profile& profile) {
  const double mode = given(stored.contour(0)) ? stored.contour(0) : 0.0;
  if (mode != 0.0 && mode != 1.0 && mode != 2.0 && mode != 3.0)
    fail(Wrong::argument_choice, column,
         {"G852", "0", text::number(mode), text::both("0, 1, 2 or 3", "0, 1, 2 или 3")});
  profile.forward = mode == 0.0 || mode == 2.0 ? -1.0 : 1.0;
  profile.outward = mode < 2.0 ? 1.0 : -1.0;
  for (int part = 0; part < 3; ++part) {
    const Sizes sizes =
        stored.sizes(stored.contour(3 * part + 1), stored.contour(3 * part + 2), stored.contour(3 * part + 3),
                     part == 0   ? "3"
                     : part == 1 ? "6"
                                 : "9");
    ProfileVector way = turned(sizes, along_z);
    way.along = std::abs(way.along);
    way.out = part == 0 ? -std::abs(way.out) : part == 2 ? std::abs(way.out) : profile.outward * way.out;
    if (std::hypot(way.along, way.out) > 1e-9) profile.parts.push_back(way);
  }
  if (profile.parts.empty()) fail(Wrong::contour_missing, column, {profile.name});
  profile.lead_in = surface(stored.contour(10), profile);
  profile.lead_out = surface(stored.contour(11), profile);
}

}  // namespace

void forget_profile(State& state) { state.own[at(Own::corners_set)] = state.own[at(Own::contour_set)] = 0.0; }

void profile_corners(Execution& run, const BlockWords& words) {
  store(run, words, Own::corners, Own::corners_set, kCornerArguments);
}

void profile_contour(Execution& run, const BlockWords& words) {
  store(run, words, Own::contour, Own::contour_set, kContourArguments);
}

void profile(Execution& run, const BlockWords& words) {
  const Arguments arguments(run, words);
  run.frames().need_plane(arguments.column());
  run.refuse_all_but(words, {});
  run.motion().end_profile();
  arguments.at_most(kCycleArguments);
  const Stored stored(run, arguments.name(), arguments.column());
  if (!stored.has_contour()) fail(Wrong::contour_missing, arguments.column(), {arguments.name()});
  const bool along_z = words.instead_word->value.number == 853.0;
  const FramesState& frames = run.state().frames;
  Profile cycle;
  cycle.name = arguments.name();
  cycle.along = along_z ? frames.axis1 : frames.axis2;
  cycle.across = along_z ? frames.axis2 : frames.axis1;
  const double z = arguments.number(0, frames.programmed[at(frames.axis1)]);
  const double x =
      arguments.given(1) ? stored.across(arguments.number(1)) : frames.programmed[at(frames.axis2)];
  cycle.begin_along = along_z ? z : x;
  cycle.begin_across = along_z ? x : z;
  take_contour(stored, along_z, arguments.column(), cycle);
  take_corners(stored, along_z, cycle);
  cycle.approach = arguments.positive(2, 1.0);
  cycle.step = arguments.positive(3, 1.0, true);
  const double mode = arguments.number(7);
  if (mode != 0.0 && mode != 1.0 && mode != 2.0)
    fail(Wrong::argument_choice, arguments.column(),
         {cycle.name, "7", text::number(mode), text::both("0, 1 or 2", "0, 1 или 2")});
  if (arguments.number(6) != 0.0)
    fail(Wrong::argument_choice, arguments.column(),
         {cycle.name, "6", text::number(arguments.number(6)), "0"});
  cycle.roughs = mode != 2.0;
  cycle.finishes = mode != 0.0;
  const double allow_z = arguments.positive(4, 1.0), allow_x = arguments.positive(5, 1.0);
  cycle.allow_along = along_z ? allow_z : allow_x;
  cycle.allow_out = along_z ? allow_x : allow_z;
  cycle.square = arguments.number(8) != 0.0;
  cycle.feed = arguments.positive(9, 0.0);
  cycle.last_feed = arguments.positive(10, 0.0);
  cycle.rpm = arguments.positive(11, 0.0);
  cycle.last_rpm = arguments.positive(12, 0.0);
  turn_profile(run, cycle);
}

}  // namespace servogate::program::fenix
