// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/drive_link.hpp"

namespace servogate::canopen {

/// One capture with the drive's touch probe (60B8h-60BDh), zero mark or probe input. It says what to write,
/// what to poll and what to read; whoever owns the objects does it over PDO or SDO. Source: CiA 402-2, "Touch
/// probe functionality". All members are real-time safe.
///
/// Before every capture the function is switched off and the drive's answer awaited, so a capture of the time
/// before is never taken for a new one.
class TouchProbe {
 public:
  /// The command's level: a rise arms one capture, FALSE disarms. A change of source or edge while armed
  /// starts anew.
  void command(bool arm, image::LatchSource source, bool negative_edge) noexcept;
  /// Communication begins anew.
  void restart() noexcept;

  /// Value that 60B8h is to have.
  std::uint16_t function() const noexcept;
  /// TRUE while 60B9h is of interest.
  bool wants_status() const noexcept {
    return phase_ == Phase::clearing || phase_ == Phase::arming || phase_ == Phase::armed;
  }
  /// Object (60BAh-60BDh) to be read now, 0: none.
  std::uint16_t wants_value() const noexcept {
    return phase_ == Phase::reading ? value_object() : std::uint16_t{0};
  }
  /// The object in which the capture in hand will appear, 0 when disarmed.
  std::uint16_t value_object() const noexcept;

  /// A value of 60B9h that the drive produced after function() was written.
  void on_status(std::uint16_t status) noexcept;
  /// The value asked for. `position_counts` (near the capture) gives the bits above the object's 32.
  void on_value(std::int32_t raw, std::int64_t position_counts) noexcept;

  std::int64_t latch_counts() const noexcept { return latch_counts_; }
  std::uint32_t sequence() const noexcept { return sequence_; }

 private:
  enum class Phase : std::uint8_t { off, clearing, arming, armed, reading, captured };

  Phase phase_ = Phase::off;
  image::LatchSource source_ = image::LatchSource::zero_mark;
  bool negative_ = false;
  std::int64_t latch_counts_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace servogate::canopen
