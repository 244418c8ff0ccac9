// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "kernel/path/law/speed.hpp"

namespace servogate::path {

/// Times of a law: seconds that interval `k` takes.
double interval_time(std::span<const double> beta, std::size_t k, double step);

/// Looks at the course as it is published, at five places of each of the first `intervals`, with the
/// derivatives of either side of a knot: by how much it exceeds the full limits, as a factor for
/// SpeedLaw::tighten(), 0 or below 1 where it does not. Not real-time safe.
void judge(const SpeedProblem& problem, std::size_t intervals, std::vector<double>& excess);

}  // namespace servogate::path
