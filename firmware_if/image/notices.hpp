// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/image/alarm.hpp"

namespace servogate::image {

inline constexpr int kNoticesPerCycle = 16;  ///< faults told in one cycle; more are counted

/// Faults that somebody tells the cycle; it makes alarms of them. Bounded. real-time safe.
class Notices {
 public:
  /// Reports a fault; beyond kNoticesPerCycle in one cycle it is only counted.
  void add(const AlarmRecord& record) noexcept {
    if (count_ < kNoticesPerCycle)
      records_[static_cast<std::size_t>(count_++)] = record;
    else
      ++lost_;
  }
  std::span<const AlarmRecord> records() const noexcept {
    return {records_.data(), static_cast<std::size_t>(count_)};
  }
  /// Faults that still find a place in this cycle.
  int room() const noexcept { return kNoticesPerCycle - count_; }
  void clear() noexcept { count_ = 0; }
  std::uint32_t lost() const noexcept { return lost_; }

 private:
  std::array<AlarmRecord, kNoticesPerCycle> records_{};
  int count_ = 0;
  std::uint32_t lost_ = 0;
};

}  // namespace servogate::image
