// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

namespace servogate::program::nc110::code {
namespace {

constexpr int kMaxOrigin = 99;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
const std::string& letter(const Execution& run, int axis) { return run.machine().axes[at(axis)].letter; }

int origin_number(const Execution& run, const Operands& operands) {
  const double number = run.numbers().resolve(operands.items[0].value);
  if (!(number >= 0.0 && number <= kMaxOrigin) || number != static_cast<int>(number))
    fail(Wrong::origin_range, operands.items[0].value.column,
         {std::string(operands.rule->name), std::to_string(kMaxOrigin), text::number(number)});
  return static_cast<int>(number);
}

/// "0, 1, 5": origin 0 is always there.
std::string numbers(const std::map<int, std::map<std::string, double>>& origins) {
  std::string out = "0";
  for (const auto& [number, row] : origins)
    if (number != 0) out += ", " + std::to_string(number);
  return out;
}

std::string letters(const std::map<std::string, double>& row) {
  std::string out;
  for (const auto& [axis, value] : row) out += (out.empty() ? "" : ", ") + axis;
  return out.empty() ? text::both("no axis", "ни одной оси") : out;
}

/// The row of an origin; origin 0 is machine zero where the table has none. nullptr: machine zero.
const std::map<std::string, double>* origin_row(const Execution& run, int number, int column) {
  const auto& origins = run.state().frames.tables->origins;
  const auto row = origins.find(number);
  if (row != origins.end()) return &row->second;
  if (number != 0) fail(Fault::origin_missing, column, {std::to_string(number), numbers(origins)});
  return nullptr;
}

void use_origin(Execution& run, int number, const std::map<std::string, double>* row, int axis, int column) {
  double value = 0.0;
  if (row != nullptr) {
    const auto entry = row->find(letter(run, axis));
    if (entry != row->end())
      value = entry->second;
    else if (number != 0)
      fail(Fault::origin_without_axis, column, {std::to_string(number), letter(run, axis), letters(*row)});
  }
  run.state().frames.frame.set_origin(axis, value);
  run.state().frames.origin[at(axis)] = static_cast<std::int16_t>(number);
}

bool has(const std::map<std::string, double>* row, const std::string& axis) {
  return row == nullptr || row->contains(axis);
}

}  // namespace

void uao(Execution& run, const Operands& operands) {
  const int number = origin_number(run, operands);
  const auto* row = origin_row(run, number, operands.items[0].value.column);
  if (operands.count == 1) {
    for (int a = 0; a < run.machine().axis_count(); ++a)
      if (number == 0 || has(row, letter(run, a))) use_origin(run, number, row, a, operands.column);
  }
  for (std::size_t i = 1; i < operands.count; ++i)
    use_origin(run, number, row, operands.items[i].axis, static_cast<int>(operands.items[i].begin) + 1);
  run.frames().changed();
}

/// Origin n plus the values, for the named axes. Values of a diameter axis are radii (specification B 11).
void uot(Execution& run, const Operands& operands) {
  const int number = origin_number(run, operands);
  const auto* row = origin_row(run, number, operands.items[0].value.column);
  for (std::size_t i = 1; i < operands.count; ++i) {
    const Operand& item = operands.items[i];
    use_origin(run, number, row, item.axis, static_cast<int>(item.begin) + 1);
    Frame& frame = run.state().frames.frame;
    frame.set_origin(item.axis, frame.origin(item.axis) + run.numbers().length(item.axis, item.value, false));
  }
  run.frames().changed();
}

/// Each one adds to the origin in force (specification B 19, decision 7).
void uio(Execution& run, const Operands& operands) {
  Frame& frame = run.state().frames.frame;
  for (const Operand& item : operands)
    frame.set_origin(item.axis, frame.origin(item.axis) + run.numbers().length(item.axis, item.value, false));
  run.frames().changed();
}

/// Sets, does not toggle (specification B 19, decision 6); without axes all mirrors end.
void mir(Execution& run, const Operands& operands) {
  Frame& frame = run.state().frames.frame;
  if (operands.count == 0)
    for (int a = 0; a < run.machine().axis_count(); ++a) frame.set_mirrored(a, false);
  for (const Operand& item : operands) frame.set_mirrored(item.axis, true);
  run.frames().changed();
}

void urt(Execution& run, const Operands& operands) {
  const double angle = run.numbers().resolve(operands.items[0].value);
  if (angle != 0.0) run.frames().need_plane(operands.column);
  run.state().frames.frame.set_rotation(angle);
  run.frames().changed();
}

void scf(Execution& run, const Operands& operands) {
  Frame& frame = run.state().frames.frame;
  const double factor = operands.count > 0 ? run.numbers().resolve(operands.items[0].value) : 1.0;
  if (factor == 0.0) fail(Fault::scale_zero, operands.items[0].value.column);
  for (int a = 0; a < run.machine().axis_count(); ++a) frame.set_scale(a, operands.count > 1 ? 1.0 : factor);
  for (std::size_t i = 1; i < operands.count; ++i) frame.set_scale(operands.items[i].axis, factor);
  run.frames().changed();
}

/// Changes the table, and the origin in force where it is this one; no scale. The table's records limit the
/// numbers (specification B 4.7).
void rqo(Execution& run, const Operands& operands) {
  const int number = origin_number(run, operands);
  const auto* row = origin_row(run, number, operands.items[0].value.column);
  auto tables = std::make_shared<Tables>(*run.state().frames.tables);
  for (std::size_t i = 1; i < operands.count; ++i) {
    const Operand& item = operands.items[i];
    if (number != 0 && !has(row, letter(run, item.axis)))
      fail(Fault::origin_without_axis, static_cast<int>(item.begin) + 1,
           {std::to_string(number), letter(run, item.axis), letters(*row)});
    const double value = run.numbers().length(item.axis, item.value, false);
    tables->origins[number][letter(run, item.axis)] += value;
    Frame& frame = run.state().frames.frame;
    if (run.state().frames.origin[at(item.axis)] == number)
      frame.set_origin(item.axis, frame.origin(item.axis) + value);
  }
  run.state().frames.tables = std::move(tables);
  run.frames().changed();
}

void dpi(Execution& run, const Operands& operands) {
  if (run.state().motion.profile_open) fail(Wrong::plane_in_profile, operands.column, {"DPI"});
  const int axis1 = operands.items[0].axis, axis2 = operands.items[1].axis;
  int normal = -1;
  if (run.machine().real_axes() == 3 && axis1 < 3 && axis2 < 3) normal = 3 - axis1 - axis2;
  run.frames().set_plane(axis1, axis2, normal);
}

/// In-position windows; 0 brings the machine's own back.
void dtl(Execution& run, const Operands& operands) {
  if (run.state().motion.profile_open) fail(Wrong::plane_in_profile, operands.column, {"DTL"});
  InPosition wanted;
  for (const Operand& item : operands) {
    const double window = run.numbers().length(item.axis, item.value, false);
    const int column = static_cast<int>(item.begin) + 1;
    if (run.machine().is_virtual(item.axis)) fail(Wrong::window_virtual, column, {letter(run, item.axis)});
    if (window < 0.0)
      run.numbers().refuse_range(letter(run, item.axis), item.value, window, "0", "99999.9999");
    const double most = run.machine().axes[at(item.axis)].window_max;
    if (most > 0.0 && window > most)
      fail(Wrong::window_wide, column, {letter(run, item.axis), text::number(window), text::number(most)});
    wanted.window[at(item.axis)] = window;
    wanted.axes |= 1u << item.axis;
  }
  run.emit(wanted);
}

void dlo(Execution& run, const Operands& operands) {
  for (const Operand& item : operands) {
    const double origin = run.state().frames.frame.origin(item.axis);
    const double a = origin + run.numbers().length(item.axis, item.value),
                 b = origin + run.numbers().length(item.axis, item.second);
    run.state().frames.field_min[at(item.axis)] = std::min(a, b);
    run.state().frames.field_max[at(item.axis)] = std::max(a, b);
  }
}

}  // namespace servogate::program::nc110::code
