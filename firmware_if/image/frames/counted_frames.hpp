// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "firmware_if/image/frames/can_wire.hpp"

namespace servogate::image {

/// Lengths on the wire of the frames that somebody sent last: most of those that a cycle repeats are those of
/// the cycle before (SYNC, an axis at rest), and need not be counted again.
class CountedFrames {
 public:
  /// frame_bits() of a classic frame, or its `wire_bits` where it has them. real-time safe.
  std::uint16_t bits(const CanFrame& frame) noexcept {
    if (frame.wire_bits != 0) return frame.wire_bits;
    const std::uint32_t key = arbitration_key(frame);
    std::uint64_t data = 0;
    std::memcpy(&data, frame.data.data(), sizeof data);
    // The numbers of PDOs in their identifiers and those of nodes, which are neighbours as a rule.
    Counted& c = counted_[(frame.id ^ frame.id >> 6) % kPlaces];
    if (c.key != key || c.data != data || c.length != frame.length || c.bits == 0)
      c = {data, key, frame.length, static_cast<std::uint16_t>(frame_bits(frame))};
    return c.bits;
  }

 private:
  static constexpr std::size_t kPlaces = 16;
  struct Counted {
    std::uint64_t data = 0;  ///< its first eight bytes
    std::uint32_t key = 0;   ///< arbitration_key()
    std::uint8_t length = 0;
    std::uint16_t bits = 0;  ///< 0: nothing yet
  };
  std::array<Counted, kPlaces> counted_{};
};

}  // namespace servogate::image
