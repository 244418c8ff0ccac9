// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/drive/probe_latch.hpp"

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/drive/drive_objects.hpp"

namespace servogate::canopen {

ProbeLatch::ProbeLatch(ObjectDictionary& dictionary)
    : function_(dictionary.variable(object::kTouchProbeFunction)),
      status_(dictionary.variable(object::kTouchProbeStatus)) {
  for (std::size_t i = 0; i < 4; ++i) {
    positions_[i] = &dictionary.variable(static_cast<std::uint16_t>(object::kTouchProbe1Positive + i));
    counters_[i] = &dictionary.variable(static_cast<std::uint16_t>(object::kProbeCounter + i));
  }
}

void ProbeLatch::reset() noexcept { level_ = {}; }

void ProbeLatch::tick(const DriveInputs& inputs, const ServoState& servo, std::int64_t origin) noexcept {
  probe(0, inputs, servo, origin);
  probe(1, inputs, servo, origin);
}

void ProbeLatch::probe(int n, const DriveInputs& inputs, const ServoState& servo,
                       std::int64_t origin) noexcept {
  using namespace touch_probe;
  const int shift = kProbe2Shift * n;
  const auto function = static_cast<unsigned>(function_ >> shift) & 0xFF;
  auto status = static_cast<unsigned>(status_ >> shift) & 0xFF;
  const DriveInput input = n == 0 ? DriveInput::probe_1 : DriveInput::probe_2;
  const bool level = inputs.on(input);
  const bool changed = level != level_[static_cast<std::size_t>(n)];
  level_[static_cast<std::size_t>(n)] = level;
  const auto put = [&] {
    status_ = (status_ & ~(std::int64_t{0xFF} << shift)) | static_cast<std::int64_t>(status) << shift;
  };
  if (!(function & kEnable)) {
    status = 0;
    return put();
  }
  const bool was_enabled = status & kStatusEnabled;
  status |= kStatusEnabled;
  if (!(function & kSamplePositive)) status &= ~unsigned{kStatusPositiveStored};
  if (!(function & kSampleNegative)) status &= ~unsigned{kStatusNegativeStored};
  const bool zero = function & kZeroImpulse;
  const bool event = zero ? servo.zero_mark : changed;
  // An edge in the very tick of enabling is older than the request.
  if (event && was_enabled) {
    const std::int64_t position = (zero ? servo.zero_mark_position : inputs.edge(input)) - origin;
    const bool continuous = function & kContinuous;
    const auto take = [&](unsigned sample, unsigned stored, bool negative) {
      if (!(function & sample) || (!continuous && (status & stored))) return;
      capture(n, negative, position);
      status |= stored;
    };
    if (zero || level) take(kSamplePositive, kStatusPositiveStored, false);
    if (zero || !level) take(kSampleNegative, kStatusNegativeStored, true);
  }
  put();
}

void ProbeLatch::capture(int n, bool negative, std::int64_t position) noexcept {
  const auto i = static_cast<std::size_t>(2 * n + (negative ? 1 : 0));
  *positions_[i] = static_cast<std::int32_t>(position);
  *counters_[i] = static_cast<std::uint16_t>(*counters_[i] + 1);
}

}  // namespace servogate::canopen
