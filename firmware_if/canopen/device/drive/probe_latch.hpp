// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/canopen/device/drive/homing.hpp"
#include "firmware_if/canopen/device/drive/servo.hpp"

namespace servogate::canopen {

/// Touch probes 1 and 2: function 60B8h, status 60B9h, positions 60BAh-60BDh, counters 60D5h-60D8h; sources
/// are the probe input and the zero mark. Source: CiA 402-2, "Touch probe functionality".
class ProbeLatch {
 public:
  /// Not real-time safe; the rest is.
  explicit ProbeLatch(ObjectDictionary& dictionary);
  /// True while there is work for tick().
  bool enabled() const noexcept { return (function_ | status_) != 0; }
  /// One servo tick; `origin` is the encoder position of the drive's zero.
  void tick(const DriveInputs& inputs, const ServoState& servo, std::int64_t origin) noexcept;
  void reset() noexcept;

 private:
  void probe(int n, const DriveInputs& inputs, const ServoState& servo, std::int64_t origin) noexcept;
  void capture(int n, bool negative, std::int64_t position) noexcept;

  std::int64_t& function_;
  std::int64_t& status_;
  std::array<std::int64_t*, 4> positions_{};  ///< 1 positive, 1 negative, 2 positive, 2 negative
  std::array<std::int64_t*, 4> counters_{};
  std::array<bool, 2> level_{};
};

}  // namespace servogate::canopen
