// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/units.hpp"

#include <charconv>
#include <cmath>

#include "firmware_if/text/finding.hpp"

namespace servogate::machine {

namespace {

/// value in the key's unit = number * times / by: a division keeps "1 ms" the double nearest to 0.001.
struct Spelling {
  Unit unit;
  bool rotary;  ///< for axis units: which kind of axis
  std::string_view name;
  double times;
  double by;
};
// The first of a unit and kind is its own name.
constexpr Spelling kSpellings[] = {
    {Unit::mm, false, "mm", 1, 1},
    {Unit::mm, false, "um", 1, 1000},
    {Unit::mm, false, "µm", 1, 1000},
    {Unit::mm, false, "m", 1000, 1},
    {Unit::axis_length, false, "mm", 1, 1},
    {Unit::axis_length, false, "um", 1, 1000},
    {Unit::axis_length, false, "µm", 1, 1000},
    {Unit::axis_length, false, "m", 1000, 1},
    {Unit::axis_length, true, "deg", 1, 1},
    {Unit::axis_length, true, "°", 1, 1},
    {Unit::axis_velocity, false, "mm/s", 1, 1},
    {Unit::axis_velocity, false, "m/s", 1000, 1},
    {Unit::axis_velocity, false, "mm/min", 1, 60},
    {Unit::axis_velocity, false, "m/min", 1000, 60},
    {Unit::axis_velocity, true, "deg/s", 1, 1},
    {Unit::axis_velocity, true, "deg/min", 1, 60},
    {Unit::axis_velocity, true, "rpm", 6, 1},
    {Unit::axis_acceleration, false, "mm/s2", 1, 1},
    {Unit::axis_acceleration, false, "mm/s²", 1, 1},
    {Unit::axis_acceleration, false, "m/s2", 1000, 1},
    {Unit::axis_acceleration, false, "m/s²", 1000, 1},
    {Unit::axis_acceleration, true, "deg/s2", 1, 1},
    {Unit::axis_acceleration, true, "deg/s²", 1, 1},
    {Unit::axis_jerk, false, "mm/s3", 1, 1},
    {Unit::axis_jerk, false, "mm/s³", 1, 1},
    {Unit::axis_jerk, false, "m/s3", 1000, 1},
    {Unit::axis_jerk, false, "m/s³", 1000, 1},
    {Unit::axis_jerk, true, "deg/s3", 1, 1},
    {Unit::axis_jerk, true, "deg/s³", 1, 1},
    {Unit::axis_lead, false, "mm/rev", 1, 1},
    {Unit::axis_lead, false, "mm", 1, 1},
    {Unit::axis_lead, true, "deg/rev", 1, 1},
    {Unit::axis_lead, true, "deg", 1, 1},
    {Unit::second, false, "s", 1, 1},
    {Unit::second, false, "ms", 1, 1000},
    {Unit::second, false, "us", 1, 1000000},
    {Unit::second, false, "µs", 1, 1000000},
    {Unit::second, false, "min", 60, 1},
    {Unit::rpm, false, "rpm", 1, 1},
    {Unit::rpm, false, "1/min", 1, 1},
    {Unit::rpm_per_s, false, "rpm/s", 1, 1},
    {Unit::bit_per_s, false, "bit/s", 1, 1},
    {Unit::bit_per_s, false, "kbit/s", 1000, 1},
    {Unit::bit_per_s, false, "Mbit/s", 1000000, 1},
    {Unit::per_s, false, "1/s", 1, 1},
    {Unit::percent, false, "%", 1, 1},
    {Unit::newton_metre, false, "N m", 1, 1},
    {Unit::newton_metre, false, "Nm", 1, 1},
    {Unit::kg_m2, false, "kg m2", 1, 1},
    {Unit::kg_m2, false, "kg m²", 1, 1},
    {Unit::kg_m2, false, "kg cm2", 1, 10000},
    {Unit::newton_metre_s_rad, false, "N m s/rad", 1, 1},
    {Unit::counts, false, "counts", 1, 1},
    {Unit::bytes, false, "bytes", 1, 1},
    {Unit::hertz, false, "Hz", 1, 1},
};

bool fits(const Spelling& s, Unit unit, AxisUnits axis) {
  const bool axis_unit = unit >= Unit::axis_length && unit <= Unit::axis_lead;
  return s.unit == unit &&
         (!axis_unit || axis == AxisUnits::either || s.rotary == (axis == AxisUnits::rotary));
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

std::string unit_name(Unit unit, AxisUnits axis) {
  std::string linear, rotary;
  for (const Spelling& s : kSpellings) {
    std::string& name = s.rotary ? rotary : linear;
    if (fits(s, unit, axis) && name.empty()) name = s.name;
  }
  if (linear.empty() || rotary.empty()) return linear + rotary;
  return linear + " (" + rotary + ")";
}

std::string milliseconds(double seconds) {
  const std::string ms = text::number(seconds * 1e3);
  return text::both(ms + " ms", ms + " мс");
}

std::string unit_spellings(Unit unit, AxisUnits axis) {
  std::string out;
  for (const Spelling& s : kSpellings)
    if (fits(s, unit, axis)) out += (out.empty() ? "" : ", ") + std::string(s.name);
  return out;
}

Quantity parse_quantity(std::string_view text, Unit unit, AxisUnits axis) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) return {0.0, QuantityError::not_a_number};
  const std::string_view name = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  for (const Spelling& s : kSpellings)
    if (fits(s, unit, axis) && s.name == name)
      return {number * s.times / s.by, QuantityError::none, s.name, s.by / s.times};
  return {0.0, name.empty() ? QuantityError::no_unit : QuantityError::wrong_unit};
}

}  // namespace servogate::machine
