// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/gate/guarded_places.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::cycle {

using image::Place;

namespace {

template <std::size_t N>
bool marked(const image::InterfaceField (&block)[N], std::uint32_t base, const Place& place) noexcept {
  return std::any_of(std::begin(block), std::end(block), [&](const image::InterfaceField& f) {
    return f.guards && image::place(f, base).overlaps(place);
  });
}

bool is_switch(const std::optional<axis::SwitchPlace>& s, const Place& place) noexcept {
  return s && s->place.overlaps(place);
}

bool of_axis(const axis::Axis& axis, const Place& place) noexcept {
  const axis::AxisConfig& c = axis.config();
  return marked(image::kAxisFields, image::axis_base(axis.index()), place) ||
         (c.auxiliary && marked(image::kMotionFields, image::motion_base(axis.index()), place)) ||
         is_switch(c.limit_plus, place) || is_switch(c.limit_minus, place) ||
         is_switch(c.home_switch, place) ||
         (c.brake.output == axis::BrakeOutput::place && c.brake.place.place.overlaps(place));
}

bool of_spindle(const axis::Spindle& spindle, const Place& place) noexcept {
  if (marked(image::kSpindleFields, image::spindle_base(spindle.index()), place)) return true;
  const std::optional<axis::InverterConfig>& inverter = spindle.config().inverter;
  return inverter && (inverter->speed.overlaps(place) || (inverter->cw && inverter->cw->overlaps(place)) ||
                      (inverter->ccw && inverter->ccw->overlaps(place)));
}

}  // namespace

bool guards_motion(const Place& place, const GuardedMachine& machine) noexcept {
  if (marked(image::kMachineFields, image::kMachineBase, place)) return true;
  for (int p = 0; p < machine.processes; ++p)
    if (marked(image::kProcessFields, image::process_base(p), place)) return true;
  return std::any_of(machine.axes.begin(), machine.axes.end(),
                     [&](const axis::Axis& a) { return of_axis(a, place); }) ||
         std::any_of(machine.spindles.begin(), machine.spindles.end(),
                     [&](const axis::Spindle& s) { return of_spindle(s, place); });
}

}  // namespace servogate::cycle
