// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

/// The way from programmed coordinates (mm, degrees, radius) to machine coordinates: scale, then mirror, then
/// rotation in the plane about the origin, then origin and tool length. Source: specification B 4 and B 19,
/// decision 11.
class Frame {
 public:
  explicit Frame(int axes = 0) : axes_(axes) { scale_.fill(1.0); }

  double origin(int axis) const noexcept { return origin_[at(axis)]; }
  void set_origin(int axis, double mm) noexcept { origin_[at(axis)] = mm; }
  double length(int axis) const noexcept { return length_[at(axis)]; }
  void set_length(int axis, double mm) noexcept { length_[at(axis)] = mm; }
  /// Of the program's own zero from the origin, along the axes of the machine.
  double offset(int axis) const noexcept { return offset_[at(axis)]; }
  void set_offset(int axis, double mm) noexcept { offset_[at(axis)] = mm; }
  double scale(int axis) const noexcept { return scale_[at(axis)]; }
  void set_scale(int axis, double factor) noexcept;
  bool mirrored(int axis) const noexcept { return (mirror_ >> axis & 1u) != 0; }
  void set_mirrored(int axis, bool on) noexcept;
  void set_rotation(double degrees) noexcept;
  double rotation() const noexcept { return angle_deg_; }
  /// Plane of the rotation; without one of its axes (-1) nothing is turned.
  void set_plane(int axis1, int axis2) noexcept;

  /// True when an axis' machine coordinate depends on its own programmed coordinate only.
  bool separate(int axis) const noexcept {
    return angle_deg_ == 0.0 || axis1_ < 0 || axis2_ < 0 || (axis != axis1_ && axis != axis2_);
  }
  /// No scale, mirror or rotation: programmed and machine coordinates differ by a shift.
  bool shift_only() const noexcept { return shift_only_; }
  double shift(int axis) const noexcept { return origin_[at(axis)] + offset_[at(axis)] + length_[at(axis)]; }

  /// Machine coordinate of one axis of a programmed point.
  double to_machine(const Position& programmed, int axis) const noexcept;
  /// Programmed coordinate of one axis of a machine point.
  double to_programmed(const Position& machine, int axis) const noexcept;
  friend bool operator==(const Frame&, const Frame&) = default;
  /// Sense of rotation in the plane after mirroring: -1 when turned round.
  int sense(int axis1, int axis2) const noexcept;

 private:
  static std::size_t at(int axis) noexcept { return static_cast<std::size_t>(axis); }
  double linear(const Position& programmed, int axis) const noexcept {
    return programmed[at(axis)] * scale_[at(axis)] * (mirrored(axis) ? -1.0 : 1.0);
  }
  void renew() noexcept;

  int axes_;
  int axis1_ = -1, axis2_ = -1;
  Position origin_{}, offset_{}, length_{}, scale_{};
  std::uint32_t mirror_ = 0;
  double angle_deg_ = 0.0, cos_ = 1.0, sin_ = 0.0;
  bool shift_only_ = true;
};

}  // namespace servogate::program
