// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware_if/image/edges.hpp"
#include "firmware_if/image/points/point_rule.hpp"
#include "firmware_if/image/process_image.hpp"

namespace servogate::image {

/// When a group is too old; 0: its device says by itself when it is lost.
struct AgeLimits {
  Nanoseconds stale_ns = 0;
  Nanoseconds bad_ns = 0;
};

/// Between a device and packet A: inverts, scales, debounces, holds back small changes, puts values of loss
/// into the packet, and keeps age and quality of one source. So a point is worth the same whatever carries
/// it. A device says what it has read (take(), edge(), fresh(), lost(), fault()) and then settle() once in
/// each receive(); of outputs it asks raw(). All but the constructor is real-time safe.
class PointStage {
 public:
  PointStage() = default;
  /// `source`: index in ProcessImage::sources, -1: its health is shown nowhere. No groups: one without age.
  explicit PointStage(std::vector<PointRule> points, int source = -1, std::vector<AgeLimits> groups = {});

  std::size_t size() const noexcept { return points_.size(); }
  const PointRule& rule(std::size_t point) const noexcept { return points_[point].rule; }

  /// The value of an input as the wire has it; digital: not 0 is on.
  void take(std::size_t point, double raw) noexcept;
  /// The same of a digital input whose device knows when it changed.
  void edge(std::size_t point, bool raw, Nanoseconds t) noexcept;
  /// What was taken of this group is of the time `t`; values that did not change are not taken again.
  void fresh(std::size_t group, Nanoseconds t) noexcept;
  /// The group is known to be gone until it is fresh again: its inputs have their values of loss from the
  /// next settle() on.
  void lost(std::size_t group) noexcept;
  /// An access failed; counted.
  void fault() noexcept { ++errors_; }
  /// Puts inputs, edges and the health of the source into the image.
  void settle(ProcessImage& image) noexcept;

  /// An output as the wire gets it; digital: 0 or 1, analog: neither rounded nor limited.
  double raw(std::size_t point, const Packets& packets) const noexcept;
  bool level(std::size_t point, const Packets& packets) const noexcept {
    return packets.bit(points_[point].rule.place) != points_[point].rule.inverted;
  }
  /// Age of a group judged at `t`.
  Quality quality(std::size_t group, Nanoseconds t) const noexcept;

 private:
  struct Point {
    PointRule rule;
    double value = 0.0;  ///< newest, in the units of the place
    bool known = false;  ///< `value` was taken or is that of loss
    bool started = false;
    bool seen = false, shown = false;  ///< digital: newest level that settle() saw, and the one in the packet
    Nanoseconds changed_ns = 0;
  };
  struct Group {
    AgeLimits limits;
    Nanoseconds updated_ns = -1;  ///< -1: never
    bool lost = false;
  };
  void show(Point& point, ProcessImage& image) noexcept;
  void judge(ProcessImage& image) const noexcept;

  std::vector<Point> points_;
  std::vector<Group> groups_;
  int source_ = -1;
  std::uint32_t errors_ = 0;
  Nanoseconds start_ns_ = -1;
  Edges edges_;
};

}  // namespace servogate::image
