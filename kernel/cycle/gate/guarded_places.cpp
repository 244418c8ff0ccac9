// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/gate/guarded_places.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::cycle {

using image::Place;

namespace {

constexpr Place kPowerOn = image::field(image::kMachineFields, "power_on", image::kMachineBase);

/// Of an axis: add its base.
constexpr Place kSaid[] = {
    image::field(image::kAxisFields, "enabled"),       image::field(image::kAxisFields, "homed"),
    image::field(image::kAxisFields, "on_limit_plus"), image::field(image::kAxisFields, "on_limit_minus"),
    image::field(image::kAxisFields, "limit_plus"),    image::field(image::kAxisFields, "limit_minus"),
    image::field(image::kAxisFields, "home_switch"),   image::field(image::kAxisFields, "brake_release")};
constexpr Place kPermitted[] = {image::field(image::kAxisFields, "enable"),
                                image::field(image::kAxisFields, "feed_enable")};

template <std::size_t N>
bool of_axis(const Place (&places)[N], const Place& place, const axis::Axis& axis) noexcept {
  return std::any_of(std::begin(places), std::end(places), [&](const Place& p) {
    return image::at(p, image::axis_base(axis.index())).overlaps(place);
  });
}

bool is_switch(const std::optional<axis::SwitchPlace>& s, const Place& place) noexcept {
  return s && s->place.overlaps(place);
}

bool is_permission(const Place& place, std::span<const axis::Axis> axes) noexcept {
  return kPowerOn.overlaps(place) || std::any_of(axes.begin(), axes.end(), [&](const axis::Axis& a) {
           return of_axis(kPermitted, place, a);
         });
}

}  // namespace

bool guards_motion(const Place& place, std::span<const axis::Axis> axes) noexcept {
  if (is_permission(place, axes)) return true;
  return std::any_of(axes.begin(), axes.end(), [&](const axis::Axis& a) {
    const axis::AxisConfig& c = a.config();
    return of_axis(kSaid, place, a) || is_switch(c.limit_plus, place) || is_switch(c.limit_minus, place) ||
           is_switch(c.home_switch, place) ||
           (c.brake.output == axis::BrakeOutput::place && c.brake.place.place.overlaps(place));
  });
}

bool withdraws(const Place& place, double value, std::span<const axis::Axis> axes) noexcept {
  return place.format == image::Format::bl && value == 0.0 && is_permission(place, axes);
}

}  // namespace servogate::cycle
