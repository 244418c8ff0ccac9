// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "bench/path/optimum/tube.hpp"
#include "bench/path/works.hpp"

namespace servogate::bench {

/// Length of the programmed path, mm. All elements have one feed.
double length_of(const Program& program);

/// The programmed path in even steps, about so long.
Line programmed(const Program& program, double step);

Limits limits_of(const path::Config& config);

}  // namespace servogate::bench
