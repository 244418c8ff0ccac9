// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/frames/frames.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/geometry/degrees.hpp"

namespace servogate::program {
namespace {

constexpr double kTravelSlack = 1e-6;  ///< mm or degrees

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

struct Plane {
  int number;
  char axis1, axis2, normal;
};
Plane plane_of(Function f) {
  if (f == Function::plane_12) return {17, 'X', 'Y', 'Z'};
  if (f == Function::plane_31) return {18, 'Z', 'X', 'Y'};
  return {19, 'Y', 'Z', 'X'};
}

/// 0 where the row does not name the axis.
double entry_of(const std::map<std::string, double>& row, const std::string& letter) {
  const auto at = row.find(letter);
  return at == row.end() ? 0.0 : at->second;
}

double origin_of(const Tables& tables, int number, const std::string& letter) {
  const auto row = tables.origins.find(number);
  return row == tables.origins.end() ? 0.0 : entry_of(row->second, letter);
}

[[noreturn]] void refuse_field(const MachineModel::Axis& axis, double value, double limit,
                               std::string_view word, int column) {
  std::vector<std::string> arguments = outside_arguments(axis.letter, axis.diameter, value, limit);
  arguments.emplace_back(word);
  fail(Fault::field, column, std::move(arguments));
}

}  // namespace

void Frames::reset() {
  for (int a = 0; a < machine_.axis_count(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    state_.frame.set_scale(a, 1.0);
    state_.frame.set_mirrored(a, false);
    state_.frame.set_offset(a, 0.0);
    state_.origin[i] = 0;
    state_.field_min[i] = -1e300;
    state_.field_max[i] = 1e300;
    state_.frame.set_origin(a, origin_of(*state_.tables, 0, machine_.axes[i].letter));
  }
  state_.zones = {};
  state_.zones_active = false;
  state_.frame.set_rotation(0.0);
  select_plane(dialect_.plane, false, 0);
}

void Frames::reposition(const Position& at) {
  state_.machine = at;
  changed();
}

void Frames::adopt(Tables tables) {
  for (int a = 0; a < machine_.axis_count(); ++a) {
    const std::string& letter = machine_.axes[at(a)].letter;
    const int number = state_.origin[at(a)];
    const double moved = origin_of(tables, number, letter) - origin_of(*state_.tables, number, letter);
    state_.frame.set_origin(a, state_.frame.origin(a) + moved);
  }
  state_.tables = std::make_shared<const Tables>(std::move(tables));
  changed();
}

void Frames::preset(int axis, double value) {
  const auto i = static_cast<std::size_t>(axis);
  Position wanted = state_.programmed;
  wanted[i] = value;
  const double moved = state_.machine[i] - state_.frame.to_machine(wanted, axis);
  Tables tables = *state_.tables;
  tables.origins[state_.origin[i]][machine_.axes[i].letter] += moved;
  adopt(std::move(tables));
}

void Frames::changed() {
  for (int a = 0; a < machine_.axis_count(); ++a)
    state_.programmed[static_cast<std::size_t>(a)] = state_.frame.to_programmed(state_.machine, a);
}

void Frames::set_plane(int axis1, int axis2, int normal) {
  state_.axis1 = axis1;
  state_.axis2 = axis2;
  state_.normal = normal;
  state_.frame.set_plane(axis1, axis2);
  if (state_.frame.rotation() != 0.0) changed();
}

void Frames::select_plane(Function function, bool required, int column) {
  const Plane plane = plane_of(function);
  const int axis1 = axes_.find(plane.axis1), axis2 = axes_.find(plane.axis2);
  if (required && (axis1 < 0 || axis2 < 0)) refuse_plane(function, column);
  state_.plane = function;
  set_plane(axis1, axis2, axes_.find(plane.normal));
}

void Frames::refuse_plane(Function function, int column) const {
  const Plane plane = plane_of(function);
  const char lacking = axes_.find(plane.axis1) < 0 ? plane.axis1 : plane.axis2;
  fail(Fault::plane_missing, column,
       {std::to_string(plane.number), std::string(1, plane.axis1), std::string(1, plane.axis2),
        std::string(1, lacking)});
}

void Frames::need_plane(int column) const {
  if (state_.axis1 < 0 || state_.axis2 < 0) refuse_plane(state_.plane, column);
}

void Frames::use_origin(int number, int column) {
  const auto& origins = state_.tables->origins;
  if (number != 0 && !origins.contains(number) && !dialect_.origins_exist) {
    std::string known = "0";
    for (const auto& [other, values] : origins)
      if (other != 0) known += ", " + std::to_string(other);
    fail(Fault::origin_missing, column, {std::to_string(number), known});
  }
  for (int a = 0; a < machine_.axis_count(); ++a) {
    state_.frame.set_origin(a, origin_of(*state_.tables, number, machine_.axes[at(a)].letter));
    state_.origin[at(a)] = static_cast<std::int16_t>(number);
  }
  changed();
}

double Frames::tool_radius() const {
  const auto row =
      state_.tables->correctors.find(state_.radius_row >= 0 ? state_.radius_row : state_.active_corrector);
  return row == state_.tables->correctors.end() ? 0.0 : row->second.radius + row->second.radius_wear;
}

void Frames::use_lengths(int row) {
  if (state_.lengths_off) row = 0;
  state_.active_corrector = row;
  if (state_.lengths_by_language) return;
  const auto& correctors = state_.tables->correctors;
  const auto entry = correctors.find(row);
  for (int a = 0; a < machine_.axis_count(); ++a) {
    const bool named = row != 0 && entry != correctors.end();
    state_.frame.set_length(a, named ? entry->second.length_of(machine_.axes[at(a)].letter) : 0.0);
  }
  changed();
}

void Frames::check_axis(int axis, double value, int column) const {
  const MachineModel::Axis& a = machine_.axes[at(axis)];
  const double limit = value > a.travel_max ? a.travel_max : a.travel_min;
  if (value > a.travel_max + kTravelSlack || value < a.travel_min - kTravelSlack)
    fail(Fault::travel, column, outside_arguments(a.letter, a.diameter, value, limit));
  const double inside = value - state_.frame.length(axis);
  const double field =
      inside > state_.field_max[at(axis)] ? state_.field_max[at(axis)] : state_.field_min[at(axis)];
  if (inside > state_.field_max[at(axis)] + kTravelSlack ||
      inside < state_.field_min[at(axis)] - kTravelSlack)
    refuse_field(a, inside, field, dialect_.terms.field, column);
}

namespace {

/// True when a straight way enters the inside of a field.
bool passes(const ProtectedZone& zone, const Frame& frame, const Position& from, const Position& to) {
  double enters = 0.0, leaves = 1.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double length = frame.length(zone.axis[i]);
    const double a = from[at(zone.axis[i])] - length, way = to[at(zone.axis[i])] - length - a;
    const double low = zone.low[i] + kTravelSlack, high = zone.high[i] - kTravelSlack;
    if (way == 0.0) {
      if (a <= low || a >= high) return false;
      continue;
    }
    const double one = (low - a) / way, two = (high - a) / way;
    enters = std::max(enters, std::min(one, two));
    leaves = std::min(leaves, std::max(one, two));
  }
  return enters < leaves;
}

}  // namespace

void Frames::check_zones(const Position& from, const Position& to, int column) const {
  for (std::size_t i = 0; i < state_.zones.size(); ++i)
    if (state_.zones[i].active && passes(state_.zones[i], state_.frame, from, to))
      fail(Fault::zone, column, {std::to_string(i + 1)});
}

/// By chords of half a degree, a hundred thousandth of the radius away from the arc.
void Frames::check_zones(const Position& from, const Arc& arc, int column) const {
  const auto a1 = at(arc.axis1), a2 = at(arc.axis2);
  const int parts = static_cast<int>(std::ceil(std::abs(arc.sweep_deg) * 2.0)) + 1;
  const double x = from[a1] - arc.center1, y = from[a2] - arc.center2;
  Position last = from;
  for (int i = 1; i <= parts; ++i) {
    const double share = static_cast<double>(i) / parts, angle = arc.sweep_deg * share;
    Position next = from;
    for (int a = 0; a < machine_.axis_count(); ++a) next[at(a)] += (arc.to[at(a)] - from[at(a)]) * share;
    next[a1] = arc.center1 + x * cos_deg(angle) - y * sin_deg(angle);
    next[a2] = arc.center2 + x * sin_deg(angle) + y * cos_deg(angle);
    check_zones(last, next, column);
    last = next;
  }
}

}  // namespace servogate::program
