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
/// no edges is known to a cycle. A touch is the first edge after some rest: what its contacts do behind it
/// says nothing. All functions are real-time safe.
class Probing {
 public:
  /// Contacts bounce no longer than this after an edge.
  static constexpr double kBounce = 0.02;  // s
  /// A probe that was deflected is free when the axes are so much further back than they had gone beyond the
  /// touch, and have been there for so long.
  static constexpr double kRelease = 2.0;    // mm
  static constexpr double kReleased = 0.03;  // s
  /// A drive tells its latch within so long.
  static constexpr double kLatchPatience = 0.5;  // s

  /// `latch`: the axes' drives latch the touch at this input of theirs; nullopt: the edge of `place` tells.
  void configure(const std::optional<axis::SwitchPlace>& place,
                 std::optional<image::LatchSource> latch = std::nullopt) noexcept {
    place_ = place;
    latch_ = latch;
  }
  const std::optional<image::LatchSource>& latch() const noexcept { return latch_; }
  bool inverted() const noexcept { return place_ && place_->inverted; }
  bool present() const noexcept { return place_.has_value(); }
  /// Each cycle: what the axes measure, latched one period ago, and the probe's input.
  void look(const image::ProcessImage& image, std::span<const axis::Axis> axes) noexcept;
  bool deflected() const noexcept { return deflected_; }
  /// Its input has not changed for longer than contacts bounce.
  bool settled() const noexcept { return settled_; }
  /// It has become deflected in this cycle, after a rest.
  bool has_touched() const noexcept { return edge_; }

  /// The next touch counts, of a motion of these axes, as bits.
  void arm(std::uint32_t own) noexcept;
  /// A measuring motion is over: from where the axes stand the probe has to come free.
  void disarm() noexcept;
  /// Nothing is expected of it any more.
  void forget() noexcept { armed_ = touched_ = known_ = found_ = awaits_ = false; }
  bool armed() const noexcept { return armed_; }
  /// It has touched since it was armed, and where is known.
  bool touched() const noexcept { return touched_; }
  bool known() const noexcept { return known_; }
  /// The drive of this axis, which moved, has not latched the touch; -1: none.
  int unlatched() const noexcept { return unlatched_; }
  /// Machine coordinates of all axes then.
  const std::array<double, image::kMaxAxes>& at() const noexcept { return at_; }
  /// It has not come free although the axes have left the touch; mm that they are away.
  bool stuck() const noexcept { return stuck_s_ > kReleased; }
  double away() const noexcept { return away_; }

 private:
  struct Place {
    image::Nanoseconds t_ns = 0;
    std::array<double, image::kMaxAxes> actual{};
  };
  void take_edges(const image::ProcessImage& image) noexcept;
  void watch_release(double dt) noexcept;
  void find() noexcept;
  void take_latches(std::span<const axis::Axis> axes, double dt) noexcept;
  double distance(const std::array<double, image::kMaxAxes>& from) const noexcept;
  const Place& newest() const noexcept { return kept_[static_cast<std::size_t>(newest_)]; }

  static constexpr int kKept = 64;  // cycles
  std::optional<axis::SwitchPlace> place_;
  std::optional<image::LatchSource> latch_;
  std::array<Place, kKept> kept_{};
  int newest_ = 0, count_ = 0;
  bool deflected_ = false, edge_ = false, armed_ = false, touched_ = false, known_ = false;
  bool settled_ = true;
  double quiet_s_ = 2.0 * kBounce;  ///< since the last edge
  bool found_ = false;              ///< from the edge
  int unlatched_ = -1;
  double latch_wait_s_ = 0.0;
  image::Nanoseconds touch_ns_ = 0;
  std::array<double, image::kMaxAxes> at_{}, rest_{};
  std::uint32_t own_ = 0;
  bool awaits_ = false;  ///< it has to come free
  double beyond_ = 0.0, away_ = 0.0, stuck_s_ = 0.0;
};

}  // namespace servogate::channel
