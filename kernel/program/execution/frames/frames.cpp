// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/frames/frames.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

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
  if (number != 0 && !origins.contains(number)) {
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

void Frames::use_lengths(int row) {
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

}  // namespace servogate::program
