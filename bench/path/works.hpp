// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "kernel/path/shape/element.hpp"

namespace servogate::bench {

using Program = std::vector<path::Element>;

/// Three axes alike: 500 mm/s, and these in mm/s2 and mm/s3.
path::Config machine(double acceleration, double jerk);
inline path::Config mill() { return machine(1000, 10000); }
inline path::Config fast() { return machine(5000, 50000); }

// Contours with known times, from the origin; feeds in mm/min, contour tolerance 0.01 mm.
Program circle(double radius, double feed);
Program polygon(double radius, int blocks, double step_angle, double feed);
Program collinear(int blocks, double step, double feed);
Program zigzag(int blocks, double step, double feed);
/// Heading a random walk of 0.03 rad a block in plan and 0.01 in elevation, kept inside 95 mm.
Program random_walk(int blocks, double feed);

// What a CAM system writes.
/// Finishing of a wavy surface in rows, chords of 0.05 mm.
Program surface_rows(double feed);
/// A slot of loops that move on.
Program trochoids(double feed);
/// Letters of straight strokes with sharp corners, without lifting.
Program engraving(double feed);
/// A thread milled as a helix of short lines.
Program thread_helix(double feed);
/// Lines of 20 to 60 mm with sharp corners.
Program pocket(double feed);
/// Rows along a twisted blade, denser where it bends.
Program impeller(double feed);

}  // namespace servogate::bench
