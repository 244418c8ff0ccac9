// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::image {

/// A digital input changed at a time that its device knows better than the cycle does: before debouncing,
/// which needs longer than the edge.
struct Edge {
  Place place;
  bool level = false;    ///< of the place, after inversion
  Nanoseconds t_ns = 0;  ///< machine time, as CycleTime::t_ns
};

/// The edges of one cycle, oldest first of each device. Bounded; what finds no room is counted. real-time
/// safe.
class Edges {
 public:
  static constexpr std::size_t kCapacity = 32;
  void add(const Edge& edge) noexcept {
    if (count_ < kCapacity)
      edges_[count_++] = edge;
    else
      ++lost_;
  }
  std::span<const Edge> list() const noexcept { return {edges_.data(), count_}; }
  /// Since the start.
  std::uint32_t lost() const noexcept { return lost_; }
  /// The same, and counts from 0 again: for whoever hands it on.
  std::uint32_t take_lost() noexcept {
    const std::uint32_t lost = lost_;
    lost_ = 0;
    return lost;
  }
  void note_lost(std::uint32_t more) noexcept { lost_ += more; }
  void clear() noexcept { count_ = 0; }

 private:
  std::array<Edge, kCapacity> edges_{};
  std::uint32_t count_ = 0;
  std::uint32_t lost_ = 0;
};

}  // namespace servogate::image
