// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/frames/can_wire.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Load of a bus from the frames seen on it. All members are real-time safe.
class BusMeter {
 public:
  /// A classic frame with the intermission behind it.
  void add(const image::CanFrame& frame) noexcept {
    cycle_bits_ += image::known_bits(frame) + image::kIntermissionBits;
  }
  /// Ends a cycle of `period_ns` on a bus of `bit_rate` bit/s.
  void close_cycle(image::Nanoseconds period_ns, std::uint32_t bit_rate) noexcept;
  /// Over the last second (since the start, when that is shorter), 0-1.
  double load() const noexcept { return load_; }
  /// The fullest cycle so far. Above 1 when frames of one cycle arrived in the next.
  double worst_cycle() const noexcept { return worst_; }

 private:
  static constexpr std::size_t kBuckets = 10;
  static constexpr image::Nanoseconds kBucketNs = 100 * image::kMillisecond;
  struct Bucket {
    std::uint64_t bits = 0;
    image::Nanoseconds time_ns = 0;
  };

  std::array<Bucket, kBuckets> buckets_{};
  std::size_t bucket_ = 0;
  Bucket sum_;
  std::uint64_t cycle_bits_ = 0;
  double load_ = 0.0;
  double worst_ = 0.0;
};

}  // namespace servogate::canopen
