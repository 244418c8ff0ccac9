// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

/// Which axes of the machine follow axes that a program moves, and how. Lengths in mm, angles in degrees.
struct VirtualAxes {
  static constexpr int kMostFollowers = 3;
  static constexpr int kMostLeaders = 4;
  enum class Kind : std::uint8_t {
    none,
    polar,   ///< a linear and a rotary axis (followers 0 and 1) reach the point of two virtual ones
    linear,  ///< each follower is a sum of shares of the leaders
  };
  Kind kind = Kind::none;
  int followers = 0, leaders = 0;
  std::array<int, kMostFollowers> follower{};  ///< index of the axis
  std::array<int, kMostLeaders> leader{};
  std::array<std::array<double, kMostLeaders>, kMostFollowers> share{};
  double least_radius = 0.0;   ///< polar: no nearer to the centre
  double radius = 0.0;         ///< linear: of a cylinder that a rotary follower turns
  bool keeps_lengths = false;  ///< a way of the followers is as long as that of the leaders
  std::uint32_t barred = 0;    ///< bit of each axis that no block may name now
  Position at{};               ///< end of the last command, all axes
};

}  // namespace servogate::program
