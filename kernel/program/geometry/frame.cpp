// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/geometry/frame.hpp"

#include "kernel/program/geometry/degrees.hpp"

namespace servogate::program {

void Frame::renew() noexcept {
  shift_only_ = mirror_ == 0 && angle_deg_ == 0.0;
  for (int a = 0; a < axes_; ++a) shift_only_ = shift_only_ && scale_[at(a)] == 1.0;
}

void Frame::set_scale(int axis, double factor) noexcept {
  scale_[at(axis)] = factor;
  renew();
}

void Frame::set_mirrored(int axis, bool on) noexcept {
  mirror_ = on ? mirror_ | (1u << axis) : mirror_ & ~(1u << axis);
  renew();
}

void Frame::set_rotation(double degrees) noexcept {
  angle_deg_ = degrees;
  cos_ = cos_deg(degrees);
  sin_ = sin_deg(degrees);
  renew();
}

void Frame::set_plane(int axis1, int axis2) noexcept {
  axis1_ = axis1;
  axis2_ = axis2;
}

double Frame::to_machine(const Position& programmed, int axis) const noexcept {
  if (separate(axis)) return linear(programmed, axis) + shift(axis);
  const double x = linear(programmed, axis1_), y = linear(programmed, axis2_);
  return (axis == axis1_ ? x * cos_ - y * sin_ : x * sin_ + y * cos_) + shift(axis);
}

double Frame::to_programmed(const Position& machine, int axis) const noexcept {
  double value = machine[at(axis)] - shift(axis);
  if (!separate(axis)) {
    const double x = machine[at(axis1_)] - shift(axis1_), y = machine[at(axis2_)] - shift(axis2_);
    value = axis == axis1_ ? x * cos_ + y * sin_ : -x * sin_ + y * cos_;
  }
  return value / scale_[at(axis)] * (mirrored(axis) ? -1.0 : 1.0);
}

int Frame::sense(int axis1, int axis2) const noexcept {
  const auto negative = [&](int a) { return (scale_[at(a)] < 0.0) != mirrored(a); };
  return negative(axis1) != negative(axis2) ? -1 : 1;
}

}  // namespace servogate::program
