// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string_view>

#include "firmware_if/image/packets.hpp"

namespace servogate::program {

/// Where an expression gets what it names. Implementations throw ProgramError for what does not exist.
class ValueSource {
 public:
  virtual ~ValueSource() = default;
  virtual double parameter(int index, int column) const = 0;
  virtual double place(const image::Place& place, int column) const = 0;
};

/// Evaluates an expression that begins at `pos` of `line` and moves `pos` behind it. + - * /, signs,
/// brackets, E parameters, places, SIN COS TAN ARS ARC ART SQR ABS INT NEG MOD; angles in degrees. `source`
/// null: only the form is judged, every operand counts as 1 and no value is out of range. Throws
/// ProgramError. Source: NC-110 programmer's manual, "E parameters" (specification B 2.2).
double evaluate(std::string_view line, std::size_t& pos, const ValueSource* source);

/// Sine and cosine of degrees, exact at multiples of 90.
double sin_deg(double degrees);
double cos_deg(double degrees);

}  // namespace servogate::program
