// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

/// Division of a bit into time quanta. Source: ISO 11898-1, 11.3; sample points: CiA 301, table 1.
namespace servogate::gsusb {

/// What a controller can be set to. Segment 1 is propagation and phase segment 1 together.
struct TimingLimits {
  std::uint32_t clock_hz = 0;
  std::uint32_t segment_1_min = 0, segment_1_max = 0;
  std::uint32_t segment_2_min = 0, segment_2_max = 0;
  std::uint32_t jump_width_max = 0;
  std::uint32_t prescaler_min = 0, prescaler_max = 0, prescaler_step = 0;
};

/// In time quanta of prescaler / clock_hz seconds.
struct BitTiming {
  std::uint32_t propagation = 0;
  std::uint32_t phase_1 = 0;
  std::uint32_t phase_2 = 0;
  std::uint32_t jump_width = 0;
  std::uint32_t prescaler = 0;

  std::uint32_t quanta() const noexcept { return 1 + propagation + phase_1 + phase_2; }
  /// Where in the bit its level is read, 0 to 1.
  double sample_point() const noexcept {
    return static_cast<double>(1 + propagation + phase_1) / static_cast<double>(quanta());
  }
  /// bit/s that it makes of this clock.
  double bit_rate(std::uint32_t clock_hz) const noexcept {
    return static_cast<double>(clock_hz) / (static_cast<double>(prescaler) * quanta());
  }
};

/// Where CiA 301 wants a bit of this rate read: 87.5 %, 80 % above 500 kbit/s, 75 % above 800 kbit/s.
double recommended_sample_point(std::uint32_t bit_rate) noexcept;

/// The setting that meets the bit rate exactly and comes closest to the recommended sample point, with the
/// most quanta where several do. nullopt: this clock does not have the rate to 0.1 %. Not real-time safe.
std::optional<BitTiming> find_timing(const TimingLimits& limits, std::uint32_t bit_rate) noexcept;

}  // namespace servogate::gsusb
