// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/drive_profile.hpp"

#include <initializer_list>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

PdoWanted pdo(std::initializer_list<MappingEntry> entries, std::uint8_t transmission_type = 1) {
  PdoWanted wanted;
  for (const MappingEntry& entry : entries) wanted.mapping.add(entry);
  wanted.transmission_type = transmission_type;
  return wanted;
}

constexpr MappingEntry entry(std::uint16_t index, std::uint8_t bits) { return {index, 0, bits}; }

void clear_map(DriveProfile& profile) {
  profile.rpdo = {};
  profile.tpdo = {};
}

constexpr std::uint8_t kEveryTenthSync = 10;

}  // namespace

namespace {
bool has_deadline(const DriveProfile& profile) noexcept {
  for (const PdoWanted& pdo : profile.rpdo)
    if (pdo.used() && pdo.event_ms > 0) return true;
  return false;
}
bool watches(const DriveProfile& profile) noexcept {
  return profile.has_heartbeat_consumer || profile.guard_time_ms > 0;
}
}  // namespace

bool stops_by_itself(const DriveProfile& profile) noexcept {
  return has_deadline(profile) || (watches(profile) && profile.abort_connection_option.value_or(0) != 0);
}

bool notices_silence(const DriveProfile& profile) noexcept {
  return has_deadline(profile) || watches(profile);
}

void use_short_position_map(DriveProfile& profile) {
  using namespace object;
  clear_map(profile);
  profile.rpdo[0] = pdo({entry(kControlword, 16), entry(kTargetPosition, 32)});
  profile.tpdo[0] = pdo({entry(kStatusword, 16), entry(kPositionActual, 32)});
  profile.modes = supported_bit(OperationMode::cyclic_sync_position);
}

void use_full_position_map(DriveProfile& profile) {
  using namespace object;
  clear_map(profile);
  profile.rpdo[0] = pdo({entry(kControlword, 16), entry(kTargetPosition, 32), entry(kModesOfOperation, 8)});
  profile.rpdo[1] = pdo({entry(kTouchProbeFunction, 16)});
  profile.tpdo[0] =
      pdo({entry(kStatusword, 16), entry(kPositionActual, 32), entry(kModesOfOperationDisplay, 8)});
  profile.tpdo[1] = pdo({entry(kTouchProbeStatus, 16), entry(kTouchProbe1Positive, 32)});
  profile.tpdo[2] = pdo({entry(kDigitalInputs, 32), entry(kTorqueActual, 16), entry(kErrorCode, 16)});
  profile.modes = supported_bit(OperationMode::cyclic_sync_position);
}

void use_velocity_map(DriveProfile& profile) {
  using namespace object;
  clear_map(profile);
  profile.rpdo[0] = pdo({entry(kControlword, 16), entry(kTargetVelocity, 32)});
  profile.tpdo[0] = pdo({entry(kStatusword, 16), entry(kPositionActual, 32)});
  profile.tpdo[1] = pdo({entry(kVelocityActual, 32), entry(kTorqueActual, 16)}, kEveryTenthSync);
  profile.modes = supported_bit(profile.velocity_mode);
}

}  // namespace servogate::canopen
