// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/drive/drive_fields.hpp"

#include <algorithm>
#include <iterator>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kWritten[] = {object::kControlword,      object::kTargetPosition,
                                      object::kTargetVelocity,   object::kTargetTorque,
                                      object::kModesOfOperation, object::kTouchProbeFunction,
                                      object::kVelocityOffset,   object::kVlTargetVelocity};
constexpr std::uint16_t kRead[] = {object::kStatusword,          object::kPositionActual,
                                   object::kVelocityActual,      object::kVlVelocityActual,
                                   object::kTorqueActual,        object::kDigitalInputs,
                                   object::kErrorCode,           object::kModesOfOperationDisplay,
                                   object::kTouchProbeStatus,    object::kTouchProbe1Positive,
                                   object::kTouchProbe1Negative, object::kTouchProbe2Positive,
                                   object::kTouchProbe2Negative};

bool in(const auto& list, std::uint16_t index) noexcept {
  return std::find(std::begin(list), std::end(list), index) != std::end(list);
}

}  // namespace

bool written_in_cycle(const DriveProfile& profile, std::uint16_t index, std::uint8_t subindex) noexcept {
  if (index == object::kDigitalOutputs) return subindex == 1;
  if (index == object::kInterpolationData)
    return subindex != 0 && (subindex == profile.ip_position_entry || subindex == profile.ip_velocity_entry);
  return subindex == 0 && in(kWritten, index);
}

bool read_in_cycle(std::uint16_t index, std::uint8_t subindex) noexcept {
  return subindex == 0 && in(kRead, index);
}

}  // namespace servogate::canopen
