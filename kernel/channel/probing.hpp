// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/axis.hpp"

namespace servogate::channel {

/// The probe of a process: its edges with their times, and where the axes were then. Positions between two
/// cycles are interpolated, so that a touch is known to the accuracy of its edge's time; an input that tells
/// no edges is known to a cycle. All functions are real-time safe.
class Probing {
 public:
  void configure(const std::optional<axis::SwitchPlace>& place) noexcept { place_ = place; }
  bool present() const noexcept { return place_.has_value(); }
  /// Each cycle: what the axes measure, latched one period ago, and the probe's input.
  void look(const image::ProcessImage& image, std::span<const axis::Axis> axes) noexcept;
  /// It is deflected now, and has become so in this cycle.
  bool deflected() const noexcept { return deflected_; }
  bool has_touched() const noexcept { return edge_; }

  /// The next touch counts.
  void arm() noexcept;
  void disarm() noexcept { armed_ = touched_ = known_ = false; }
  bool armed() const noexcept { return armed_; }
  /// It has touched since it was armed, and where is known.
  bool touched() const noexcept { return touched_; }
  bool known() const noexcept { return known_; }
  /// Machine coordinates of all axes then.
  const std::array<double, image::kMaxAxes>& at() const noexcept { return at_; }

 private:
  void find() noexcept;

  static constexpr int kKept = 64;  // cycles
  struct Place {
    image::Nanoseconds t_ns = 0;
    std::array<double, image::kMaxAxes> actual{};
  };
  std::optional<axis::SwitchPlace> place_;
  std::array<Place, kKept> kept_{};
  int newest_ = 0, count_ = 0;
  bool deflected_ = false, edge_ = false, armed_ = false, touched_ = false, known_ = false;
  image::Nanoseconds touch_ns_ = 0;
  std::array<double, image::kMaxAxes> at_{};
};

}  // namespace servogate::channel
