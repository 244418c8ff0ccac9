// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

namespace servogate::machine {

/// A place in the machine file, counted from 1; 0 = not known.
struct Where {
  int line = 0;
  int column = 0;
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

}  // namespace servogate::machine
