// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Gives a drive in profile position mode one set-point after the other: the target stands, bit 4 of the
/// controlword rises, bit 12 of the statusword answers, bit 4 falls, bit 12 falls. With bit 5 each of them
/// takes over at once from the one before. Source: CiA 402-2, "Profile position mode", figure "Set-point
/// transmission". All members are real-time safe.
class SetPointHandshake {
 public:
  /// A drive that does not answer is asked again after so long.
  static constexpr image::Nanoseconds kPatienceNs = 500 * image::kMillisecond;

  /// The drive has been given nothing.
  void restart() noexcept { *this = {}; }
  /// A fresh statusword: its bit 12.
  void on_acknowledge(bool acknowledged) noexcept {
    if (phase_ == Phase::offered && acknowledged) phase_ = Phase::taken;
    if (phase_ == Phase::taken && !acknowledged) phase_ = Phase::idle;
    acknowledged_ = acknowledged;
  }
  /// Each time before the process data are sent. `arrived`: the drive has the target that target() gave
  /// before.
  void step(image::Nanoseconds now, std::int64_t wanted, bool arrived) noexcept {
    if (phase_ == Phase::offered && now - since_ns_ >= kPatienceNs) {
      phase_ = Phase::idle;
      given_.reset();
    }
    if (phase_ == Phase::placed && arrived) {
      phase_ = Phase::offered;
      since_ns_ = now;
    }
    if (phase_ != Phase::idle || acknowledged_ || given_ == wanted) return;
    given_ = wanted;
    phase_ = Phase::placed;
  }
  /// What belongs into 607Ah; nothing yet: nullopt.
  std::optional<std::int64_t> target() const noexcept { return given_; }
  bool new_set_point() const noexcept { return phase_ == Phase::offered; }

 private:
  enum class Phase : std::uint8_t {
    idle,
    placed,   ///< the target is on its way
    offered,  ///< bit 4 is set
    taken     ///< bit 12 has answered, bit 4 is withdrawn
  };
  Phase phase_ = Phase::idle;
  bool acknowledged_ = false;
  std::optional<std::int64_t> given_;
  image::Nanoseconds since_ns_ = 0;
};

}  // namespace servogate::canopen
