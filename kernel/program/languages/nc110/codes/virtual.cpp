// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

/// UAV: virtual axes, parallel axes, a turned system of coordinates. Source: specification B 13.
namespace servogate::program::nc110::code {
namespace {

using Kind = VirtualAxes::Kind;
using Matrix = std::array<std::array<double, 3>, 3>;

constexpr double kStandsAtZero = 1e-4;  ///< mm or degrees
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::string_view kForms[] = {
    "(UAV,0)",      "(UAV,1,XC,UV,r)", "(UAV,2,C,V,r)", "(UAV,3,VW,XY,12,11)", "(UAV,4,XYZ,UVW,0,0,90)",
    "(UAV,5,XZ,UV)"};
constexpr std::size_t kOperands[] = {1, 4, 4, 5, 6, 3};

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
int column(const Operand& item) { return static_cast<int>(item.begin) + 1; }

enum class Axis : std::uint8_t { linear, rotary, imagined, any };

class Definition {
 public:
  Definition(Execution& run, const Operands& operands, int mode)
      : run_(run), operands_(operands), mode_(mode), state_(run.state().frames) {}

  VirtualAxes read() {
    axes_.at = state_.machine;
    if (mode_ == 1) polar();
    if (mode_ == 2) cylinder();
    if (mode_ == 3) parallel();
    if (mode_ == 4) space();
    if (mode_ == 5) skew();
    for (int i = 0; i < axes_.leaders; ++i) axes_.barred &= ~(1u << axes_.leader[at(i)]);
    for (int i = 0; i < axes_.followers; ++i) axes_.barred |= 1u << axes_.follower[at(i)];
    return axes_;
  }

 private:
  const Operand& item(std::size_t i) const { return operands_.items[i]; }
  [[noreturn]] void bad_form(const Operand& where) const {
    fail(Wrong::virtual_form, column(where), {std::to_string(mode_), std::string(kForms[mode_])});
  }

  std::vector<int> letters(const Operand& where, std::size_t least, std::size_t most) const {
    const std::string_view text = operands_.text(where);
    if (text.size() < least || text.size() > most) bad_form(where);
    std::vector<int> out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const int place = column(where) + static_cast<int>(i);
      if (!is_capital(text[i])) bad_form(where);
      const int axis = run_.axes().find(text[i]);
      if (axis < 0) fail(Fault::axis_missing, place, {std::string(1, text[i])});
      if (std::find(out.begin(), out.end(), axis) != out.end())
        fail(Wrong::operand_axis_twice, place, {"UAV", std::string(1, text[i])});
      out.push_back(axis);
    }
    return out;
  }

  int axis(int index, Axis wanted, const Operand& where, int offset = 0) const {
    const bool imagined = run_.machine().is_virtual(index), rotary = run_.machine().rotary(index);
    const bool good = wanted == Axis::any        ? !imagined
                      : wanted == Axis::imagined ? imagined
                                                 : !imagined && rotary == (wanted == Axis::rotary);
    if (good) return index;
    const std::string kind =
        wanted == Axis::linear ? text::both("linear axis of the machine", "линейная ось станка")
        : wanted == Axis::rotary ? text::both("rotary axis of the machine", "поворотная ось станка")
        : wanted == Axis::any ? text::both("axis of the machine", "ось станка")
                              : text::both("virtual axis", "виртуальная ось");
    fail(Wrong::virtual_axis, column(where) + offset, {run_.machine().axes[at(index)].letter, kind});
  }

  double number(const Operand& where) const {
    BlockText text{run_.dialect(), run_.axes(), *operands_.block, operands_.block->line.substr(0, where.end),
                   where.begin};
    const Value value = read_value(text, "UAV");
    if (text.pos != where.end) bad_form(where);
    return run_.numbers().resolve(value);
  }
  /// A radius in the unit of dimensions.
  double radius(const Operand& where) const {
    const double value = number(where) * (run_.state().modes.unit == Function::inch ? 25.4 : 1.0);
    if (!(value > 0.0)) fail(Wrong::virtual_radius_value, column(where));
    return value;
  }
  void stands_at_zero(int index, const Operand& where) const {
    const double programmed = state_.programmed[at(index)];
    if (std::abs(programmed) > kStandsAtZero)
      fail(Wrong::virtual_zero, column(where),
           {run_.machine().axes[at(index)].letter, text::number(programmed, 4)});
  }

  /// The followers stand where they stand: the virtual axes begin there.
  void begin_at(int leader, double value) { axes_.at[at(leader)] = value; }
  double programmed(int follower) const {
    return state_.machine[at(follower)] - state_.frame.shift(follower);
  }

  void polar() {
    const std::vector<int> real = letters(item(1), 2, 2), imagined = letters(item(2), 2, 2);
    axes_.kind = Kind::polar;
    axes_.followers = axes_.leaders = 2;
    axes_.follower = {axis(real[0], Axis::linear, item(1)), axis(real[1], Axis::rotary, item(1), 1)};
    axes_.leader = {axis(imagined[0], Axis::imagined, item(2)),
                    axis(imagined[1], Axis::imagined, item(2), 1)};
    axes_.least_radius = radius(item(3));
    stands_at_zero(real[1], item(1));
    const double begins = programmed(real[0]);
    if (begins < axes_.least_radius)
      fail(Fault::virtual_radius, column(item(1)),
           {text::number(begins, 4), text::number(axes_.least_radius, 4)});
    begin_at(imagined[0], begins);
    begin_at(imagined[1], 0.0);
  }

  void cylinder() {
    const std::vector<int> real = letters(item(1), 1, 1), imagined = letters(item(2), 1, 1);
    axes_.kind = Kind::linear;
    axes_.followers = axes_.leaders = 1;
    axes_.follower[0] = axis(real[0], Axis::rotary, item(1));
    axes_.leader[0] = axis(imagined[0], Axis::imagined, item(2));
    axes_.radius = radius(item(3));
    axes_.share[0][0] = 1.0 / (kDegree * axes_.radius);
    stands_at_zero(real[0], item(1));
    begin_at(imagined[0], 0.0);
  }

  void parallel() {
    const std::vector<int> slaves = letters(item(1), 1, 3), masters = letters(item(2), 1, 4);
    const std::string_view map = operands_.text(item(3)), sense = operands_.text(item(4));
    axes_.kind = Kind::linear;
    axes_.followers = static_cast<int>(slaves.size());
    axes_.leaders = static_cast<int>(masters.size());
    for (std::size_t k = 0; k < masters.size(); ++k)
      axes_.leader[k] = axis(masters[k], Axis::any, item(2), static_cast<int>(k));
    for (std::size_t i = 0; i < slaves.size(); ++i) {
      axes_.follower[i] = axis(slaves[i], Axis::any, item(1), static_cast<int>(i));
      if (std::find(masters.begin(), masters.end(), slaves[i]) != masters.end())
        fail(Wrong::operand_axis_twice, column(item(1)), {"UAV", run_.machine().axes[at(slaves[i])].letter});
    }
    const auto digit = [&](std::string_view digits, std::size_t i, std::size_t most, const Operand& where) {
      if (digits.size() != slaves.size() || digits[i] < '1' || digits[i] > static_cast<char>('0' + most))
        fail(Wrong::parallel_digits, column(where),
             {std::string(digits), std::to_string(slaves.size()), std::to_string(most)});
      return static_cast<std::size_t>(digits[i] - '1');
    };
    for (std::size_t i = 0; i < slaves.size(); ++i) {
      const std::size_t master = digit(map, i, masters.size(), item(3));
      const bool mirrored = digit(sense, i, 2, item(4)) == 1;
      if (run_.machine().rotary(slaves[i]) != run_.machine().rotary(masters[master]))
        axis(slaves[i], run_.machine().rotary(masters[master]) ? Axis::rotary : Axis::linear, item(1),
             static_cast<int>(i));
      axes_.share[i][master] = mirrored ? -1.0 : 1.0;
      stands_at_zero(slaves[i], item(1));
      stands_at_zero(masters[master], item(2));
    }
  }

  void three(const std::vector<int>& real, const std::vector<int>& imagined) {
    axes_.kind = Kind::linear;
    axes_.followers = static_cast<int>(real.size());
    axes_.leaders = axes_.followers;
    for (std::size_t i = 0; i < real.size(); ++i) {
      axes_.follower[i] = axis(real[i], Axis::linear, item(1), static_cast<int>(i));
      axes_.leader[i] = axis(imagined[i], Axis::imagined, item(2), static_cast<int>(i));
    }
  }

  /// Turns about the first, then the second, then the third axis as they stand (specification B 19, decision
  /// 17).
  void space() {
    const std::vector<int> real = letters(item(1), 3, 3), imagined = letters(item(2), 3, 3);
    three(real, imagined);
    Matrix turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (std::size_t n = 0; n < 3; ++n) {
      const double angle = number(item(3 + n));
      const std::size_t i = (n + 1) % 3, k = (n + 2) % 3;
      Matrix next = turn;
      for (std::size_t c = 0; c < 3; ++c) {
        next[i][c] = turn[i][c] * cos_deg(angle) - turn[k][c] * sin_deg(angle);
        next[k][c] = turn[i][c] * sin_deg(angle) + turn[k][c] * cos_deg(angle);
      }
      turn = next;
    }
    axes_.keeps_lengths = true;
    for (std::size_t i = 0; i < 3; ++i) {
      double value = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        axes_.share[i][k] = turn[i][k];
        value += turn[k][i] * programmed(real[k]);
      }
      begin_at(imagined[i], value);
    }
  }

  /// The second real axis stands at UGF degrees to the first one.
  void skew() {
    const std::vector<int> real = letters(item(1), 2, 2), imagined = letters(item(2), 2, 2);
    three(real, imagined);
    const double angle = run_.state().own[nc110::at(Own::skew)], sine = sin_deg(angle);
    if (std::abs(sine) < 1e-6) fail(Wrong::skew_angle, operands_.column);
    axes_.share[0][0] = 1.0;
    axes_.share[0][1] = -cos_deg(angle) / sine;
    axes_.share[1][1] = 1.0 / sine;
    begin_at(imagined[0], programmed(real[0]) + programmed(real[1]) * cos_deg(angle));
    begin_at(imagined[1], programmed(real[1]) * sine);
  }

  Execution& run_;
  const Operands& operands_;
  int mode_;
  const FramesState& state_;
  VirtualAxes axes_ = no_virtual_axes(run_.machine());
};

}  // namespace

void uav(Execution& run, const Operands& operands) {
  const int mode = run.numbers().whole(operands.items[0].value, "UAV");
  if (mode > 5) fail(Wrong::virtual_mode, operands.items[0].value.column, {std::to_string(mode)});
  if (operands.count != kOperands[mode])
    fail(Wrong::virtual_form, operands.column, {std::to_string(mode), std::string(kForms[mode])});
  run.motion().end_profile();
  State& state = run.state();
  end_virtual_axes(run.machine(), state.virtual_axes, state.frames.machine);
  run.frames().changed();
  if (mode == 0) return;
  const VirtualAxes axes = Definition(run, operands, mode).read();
  state.virtual_axes = axes;
  state.frames.machine = axes.at;
  run.frames().changed();
}

/// A machine file has one configuration: the initial one is in force always.
void ctl(Execution&, const Operands& operands) {
  if (operands.count > 0) fail(Wrong::configuration, column(operands.items[0]));
}

}  // namespace servogate::program::nc110::code

namespace servogate::program::nc110::variable {

/// Angle between two axes for (UAV,5). Source: specification A 19.8.
void ugf(Execution& run, double value, int, int column) {
  if (!(std::abs(value) < 180.0) || value == 0.0)
    fail(Fault::variable_range, column, {"UGF", text::number(value), "-180", "180"});
  run.state().own[at(Own::skew)] = value;
}

/// The manual names it without its format.
void daw(Execution&, double, int, int column) { fail(Wrong::analogue_output, column); }

}  // namespace servogate::program::nc110::variable
