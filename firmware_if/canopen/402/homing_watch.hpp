// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Reads bits 10, 12 and 13 of the statusword during a homing of the drive. A drive still shows the end of
/// its last homing, or the bits of another mode, for a while after the start: they count once it has been
/// seen running, or after `kSettleNs`. Source: CiA 402-2, "Homing mode". All members are real-time safe.
class HomingWatch {
 public:
  static constexpr image::Nanoseconds kSettleNs = 100 * image::kMillisecond;

  void restart() noexcept { *this = {}; }
  /// The controlword that is being sent has, or has not, the start bit in homing mode.
  void command(image::Nanoseconds now, bool start) noexcept {
    now_ = now;
    if (!start) return restart();
    if (!started_) started_ns_ = now;
    started_ = true;
  }
  /// A fresh statusword while the drive shows homing mode.
  void on_statusword(std::uint16_t word) noexcept {
    if (!started_) return;
    const bool reached = word & statusword::kTargetReached;
    const bool attained = word & statusword::kModeSpecific12, error = word & statusword::kModeSpecific13;
    ran_ = ran_ || (!reached && !attained && !error);
    if (!ran_ && now_ - started_ns_ < kSettleNs)
      state_ = image::DriveHoming::running;
    else if (error)
      state_ = image::DriveHoming::failed;
    else if (attained)
      state_ = reached ? image::DriveHoming::attained : image::DriveHoming::running;
    else
      state_ = reached ? image::DriveHoming::interrupted : image::DriveHoming::running;
  }
  image::DriveHoming state() const noexcept { return state_; }

 private:
  bool started_ = false;
  bool ran_ = false;
  image::Nanoseconds started_ns_ = 0, now_ = 0;
  image::DriveHoming state_ = image::DriveHoming::idle;
};

}  // namespace servogate::canopen
