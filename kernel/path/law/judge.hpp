// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "kernel/path/law/speed.hpp"

namespace servogate::path {

/// Times of a law: seconds that interval `k` takes.
double interval_time(std::span<const double> beta, std::size_t k, double step);

/// Looks at the course as it is published, densely in each of the first `intervals`, with the derivatives of
/// either side of a knot: how much of the full limits it uses. Not real-time safe.
void judge(const SpeedProblem& problem, std::size_t intervals, std::vector<Excess>& excess);

}  // namespace servogate::path
