// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/touch_probe.hpp"

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {

using image::LatchSource;
using namespace touch_probe;

void TouchProbe::command(bool arm, LatchSource source, bool negative_edge) noexcept {
  if (!arm) {
    phase_ = Phase::off;
    return;
  }
  const bool changed = source != source_ || negative_edge != negative_;
  if (phase_ != Phase::off && !changed) return;
  source_ = source;
  negative_ = negative_edge;
  phase_ = Phase::clearing;
}

void TouchProbe::restart() noexcept { phase_ = Phase::off; }

std::uint16_t TouchProbe::function() const noexcept {
  if (phase_ == Phase::off || phase_ == Phase::clearing) return 0;
  unsigned bits = kEnable | (negative_ ? kSampleNegative : kSamplePositive);
  if (source_ == LatchSource::zero_mark) bits |= kZeroImpulse;
  return static_cast<std::uint16_t>(source_ == LatchSource::probe_2 ? bits << kProbe2Shift : bits);
}

std::uint16_t TouchProbe::value_object() const noexcept {
  if (phase_ == Phase::off) return 0;
  if (source_ == LatchSource::probe_2)
    return negative_ ? object::kTouchProbe2Negative : object::kTouchProbe2Positive;
  return negative_ ? object::kTouchProbe1Negative : object::kTouchProbe1Positive;
}

void TouchProbe::on_status(std::uint16_t status) noexcept {
  const unsigned bits = source_ == LatchSource::probe_2 ? status >> kProbe2Shift : status;
  const bool enabled = bits & kStatusEnabled;
  const bool stored = bits & (negative_ ? kStatusNegativeStored : kStatusPositiveStored);
  if (phase_ == Phase::clearing && !enabled) {
    phase_ = Phase::arming;
  } else if (phase_ == Phase::arming && enabled) {
    phase_ = stored ? Phase::reading : Phase::armed;
  } else if (phase_ == Phase::armed && stored) {
    phase_ = Phase::reading;
  }
}

void TouchProbe::on_value(std::int32_t raw, std::int64_t position_counts) noexcept {
  if (phase_ != Phase::reading) return;
  const auto difference = static_cast<std::int32_t>(static_cast<std::uint32_t>(raw) -
                                                    static_cast<std::uint32_t>(position_counts));
  latch_counts_ = position_counts + difference;
  ++sequence_;
  phase_ = Phase::captured;
}

}  // namespace servogate::canopen
