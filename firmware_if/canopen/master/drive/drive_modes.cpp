// SPDX-License-Identifier: Apache-2.0
// The part of DriveLink that differs from mode to mode: the bits of the controlword that a mode has of its
// own.
#include "firmware_if/canopen/402/controlword.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/master/drive/drive_link.hpp"

namespace servogate::canopen {

using image::DriveState;

namespace {

/// vl: enable ramp, unlock ramp, reference ramp; without them the drive ramps to zero. Source: CiA 402-2,
/// "vl".
constexpr std::uint16_t kVlRampBits =
    controlword::kModeSpecific4 | controlword::kModeSpecific5 | controlword::kModeSpecific6;

}  // namespace

std::uint16_t DriveLink::mode_bits(image::Nanoseconds now, std::int64_t target) noexcept {
  const bool enabled = control_.state() == DriveState::operation_enabled;
  const bool positions = enabled && mode_wanted_ == OperationMode::profile_position && mode_ready();
  if (!positions) set_points_.restart();
  follow_interpolation();
  watch_interpolation(now);
  if (!enabled) return 0;
  switch (mode_wanted_) {
    case OperationMode::velocity:
      return kVlRampBits;
    case OperationMode::interpolated_position:
      return profile_.ip_buffer && !buffer_open_ ? 0 : controlword::kModeSpecific4;
    case OperationMode::profile_position: {
      if (!positions) return 0;
      const bool arrived =
          profile_.sdo_only
              ? target_written_ == static_cast<std::uint32_t>(data_.to_send(out_.target_position))
              : data_.delivered(out_.target_position);
      set_points_.step(now, target, arrived);
      // Bit 5: each set-point takes over at once.
      return static_cast<std::uint16_t>(controlword::kModeSpecific5 |
                                        (set_points_.new_set_point() ? controlword::kModeSpecific4 : 0));
    }
    default:
      return 0;
  }
}

/// The drive takes records. Source: CiA 402-2, "Interpolated position mode", statusword bit 12.
bool DriveLink::interpolating() const noexcept {
  return control_.state() == DriveState::operation_enabled && mode_ready() &&
         (statusword_ & statusword::kModeSpecific12);
}

/// The time runs from when everything that lies before bit 12 has been done.
void DriveLink::watch_interpolation(image::Nanoseconds now) noexcept {
  const bool asked = mode_wanted_ == OperationMode::interpolated_position && mode_ready() &&
                     control_.state() == DriveState::operation_enabled &&
                     (!profile_.ip_buffer || buffer_open_);
  interpolation_waited_ms_ = 0;
  if (!asked || interpolating()) return interpolation_asked_ns_.reset();
  if (!interpolation_asked_ns_) interpolation_asked_ns_ = now;
  const auto waited = static_cast<std::int32_t>((now - *interpolation_asked_ns_) / image::kMillisecond);
  if (waited >= profile_.transition_timeout_ms) interpolation_waited_ms_ = waited;
}

// A record from before would be run to as soon as the drive interpolates. It is kept away from the drive:
// one with a PDO of its own is not sent, a buffer is closed. Where neither can be, the record is the place
// where the drive stands.
void DriveLink::follow_interpolation() noexcept {
  if (profile_.position_mode != OperationMode::interpolated_position) return;
  const bool wanted = mode_wanted_ == OperationMode::interpolated_position;
  const bool open = wanted && control_.state() == DriveState::operation_enabled;
  if (open != buffer_open_wanted_) buffer_refused_ = false;
  buffer_open_wanted_ = open;
  for (const PdoField& field : {out_.target_position, out_.ip_velocity}) {
    if (!field.mapped() || field.pdo == out_.controlword.pdo) continue;
    // A PDO with a deadline has to come.
    if (profile_.rpdo[static_cast<std::size_t>(field.pdo)].event_ms == 0)
      data_.hold(field, !(wanted && interpolating()));
  }
}

}  // namespace servogate::canopen
