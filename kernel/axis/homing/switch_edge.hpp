// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware_if/image/time.hpp"

namespace servogate::axis {

/// Where an axis was when its home switch changed, from edges with times (ProcessImage::edges): between the
/// two positions that were latched before and behind the edge. A contact that bounces has changed with its
/// first edge; an edge may come some cycles later than the level that it has led to. Times are machine time.
/// All of it is real-time safe.
class SwitchEdge {
 public:
  /// Edges closer together than this belong to one change.
  static constexpr image::Nanoseconds kBounce = 10 * image::kMillisecond;

  void reset() noexcept { *this = {}; }
  /// The axis was at `counts` at the time `t`; times rise.
  void sample(image::Nanoseconds t, std::int64_t counts) noexcept;
  void edge(bool level, image::Nanoseconds t) noexcept;
  /// A cycle that is late reads a level that is later than its own time by as much as this.
  static constexpr image::Nanoseconds kLate = 20 * image::kMillisecond;

  /// The level has been found changed to `level` in the cycle of the time `t`.
  void decide(bool level, image::Nanoseconds t) noexcept {
    level_ = level;
    seen_ns_ = t;
  }
  /// At the edge that led there; nullopt: none has come, or too late for the positions that are kept.
  std::optional<std::int64_t> counts() const noexcept;

 private:
  static constexpr std::size_t kSamples = 64, kChanges = 4;
  struct Sample {
    image::Nanoseconds t = 0;
    std::int64_t counts = 0;
  };
  struct Change {
    image::Nanoseconds begin = 0, last = 0;
    bool level = false;
    std::optional<std::int64_t> counts;  ///< at `begin`, once known
  };
  std::optional<std::int64_t> at(image::Nanoseconds t) const noexcept;

  std::array<Sample, kSamples> samples_{};
  std::size_t sampled_ = 0;
  std::array<Change, kChanges> changes_{};  ///< newest first
  std::size_t changed_ = 0;
  bool level_ = false;
  image::Nanoseconds seen_ns_ = 0;
};

}  // namespace servogate::axis
