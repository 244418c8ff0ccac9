// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/motion/motion.hpp"

#include <cmath>
#include <string>

namespace servogate::program {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

}  // namespace

/// Positions of an indexing axis as degrees. Source: specification A 17.2.
double Motion::index_angle(int axis, const Value& value) const {
  constexpr double kMost = 99999.0;
  const MachineModel::Axis& a = machine_.axes[at(axis)];
  const double positions = numbers_.resolve(value);
  if (positions != std::floor(positions))
    fail(Fault::whole_number, value.column, {a.letter, text::number(positions)});
  if (std::abs(positions) > kMost) numbers_.refuse_range(a.letter, value, positions, "-99999", "99999");
  return positions * 360.0 / a.index_positions;
}

/// True where the block moves nothing but indexing axes.
bool Motion::only_indexes(const BlockWords& words) const noexcept {
  if (!indexes_) return false;
  int named = 0;
  for (int a = 0; a < machine_.axis_count(); ++a)
    if (words.axis[at(a)] != nullptr) {
      if (machine_.axes[at(a)].index_positions == 0) return false;
      ++named;
    }
  return named > 0;
}

bool Motion::signs_direction(int axis) const noexcept {
  const MachineModel::Axis& a = machine_.axes[at(axis)];
  return dialect_.sign_is_direction && a.rotary && a.endless && a.index_positions == 0;
}

/// An absolute angle on an axis without ends: its sign, that of 0 too, is the direction. Source:
/// specification A 17.3.
double Motion::turned_to(int axis, const Value& value, double angle) const {
  if (!(std::abs(angle) < 360.0))
    numbers_.refuse_range(machine_.axes[at(axis)].letter, value, angle, "-359.9999", "359.9999");
  const double from = at_.programmed[at(axis)];
  const bool backwards =
      value.parameter < 0 ? value.negative || angle < 0.0 : std::signbit(numbers_.resolve(value));
  const auto turn = [](double degrees) {
    const double part = degrees - 360.0 * std::floor(degrees / 360.0);
    return part > 360.0 - 1e-7 ? 0.0 : part;  // it stands there
  };
  const double way = backwards ? -turn(from - std::abs(angle)) : turn(angle - from);
  return from + way;
}

/// The indexing axes turn and stand before anything else of the block moves. False: none turns. Source:
/// specification A 5.
bool Motion::index(const Position& to) {
  if (!indexes_) return false;
  Position turned = at_.machine;
  for (int a = 0; a < machine_.axis_count(); ++a)
    if (machine_.axes[at(a)].index_positions > 0) turned[at(a)] = to[at(a)];
  if (turned == at_.machine) return false;
  if (contour_.engaged())
    fail(Fault::contour_excludes, here(), {text::both("an indexing axis", "делительная ось")});
  end_profile();
  output_.emit(Rapid{turned});
  at_.machine = turned;
  return true;
}

}  // namespace servogate::program
