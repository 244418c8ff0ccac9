// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::program {

/// Sine and cosine of degrees, exact at multiples of 90.
double sin_deg(double degrees);
double cos_deg(double degrees);
/// Tangent, exact at odd multiples of 45; NaN where it has no value.
double tan_deg(double degrees);

}  // namespace servogate::program
