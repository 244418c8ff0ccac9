// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace servogate::machine {

/// Unit in which a key's number is kept. The `axis_` ones are mm for a linear and degrees for a rotary axis.
enum class Unit : std::uint8_t {
  none,
  mm,
  axis_length,
  axis_velocity,
  axis_acceleration,
  axis_jerk,
  axis_lead,
  second,
  rpm,
  rpm_per_s,
  bit_per_s,
  per_s,
  percent,
  newton_metre,
  kg_m2,
  newton_metre_s_rad,
  counts,
  bytes,
  hertz,
};
/// Which of the axis units are meant; `either` where the axis is named by the same table.
enum class AxisUnits : std::uint8_t { linear, rotary, either };

/// "mm/s", "deg/s", "mm/s (deg/s)", "" for none.
std::string unit_name(Unit unit, AxisUnits axis);
/// Every spelling that is read, for messages, schema and reference: "mm/s, m/s, mm/min, m/min".
std::string unit_spellings(Unit unit, AxisUnits axis);

/// "2.5 ms", for messages about times of a bus.
std::string milliseconds(double seconds);

enum class QuantityError : std::uint8_t { none, not_a_number, no_unit, wrong_unit };
struct Quantity {
  double value = 0.0;  ///< in the key's unit
  QuantityError error = QuantityError::none;
  std::string_view unit = {};  ///< as it was written
  double per_unit = 1.0;       ///< written units in one unit of the key
};
/// "500 mm/s", "0.5 m/s", "30 m/min": a decimal number, a unit of the right kind.
Quantity parse_quantity(std::string_view text, Unit unit, AxisUnits axis);

}  // namespace servogate::machine
