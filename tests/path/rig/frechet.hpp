// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/path/shape/element.hpp"

namespace servogate::path::test {

using Polyline = std::vector<Vector>;

/// The programmed path of elements from `start`, arcs as chords that leave the arc by at most `sagitta` mm.
/// Written from the definition of an element, independent of the planner's geometry.
Polyline programmed_path(const Vector& start, const std::vector<Element>& elements, int axes,
                         double sagitta = 2e-5);

/// Decides whether the Fréchet distance of two polylines is at most `distance` (Alt and Godau's free-space
/// diagram, only the cells that are reached).
bool frechet_within(const Polyline& a, const Polyline& b, double distance, int axes);

}  // namespace servogate::path::test
