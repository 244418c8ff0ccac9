// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::mock {

/// What can go wrong with a simulated drive on command. The first group lasts until its time is over or it is
/// cleared; the second happens once.
enum class DriveFaultKind : std::uint8_t {
  silent,            ///< sends nothing; receives and works on
  deaf,              ///< receives nothing
  heartbeat_lost,    ///< no heartbeat
  pdo_dropped,       ///< its TPDOs (or only TPDO `number`) are not sent (every `every`-th one)
  pdo_late,          ///< its TPDOs are sent `delay_ns` later
  pdo_corrupted,     ///< its TPDOs carry bits of `value` flipped in their first eight bytes
  pdo_repeated,      ///< its TPDOs repeat the old content
  rpdo_dropped,      ///< RPDOs (or only RPDO `number`) do not reach it (every `every`-th one)
  rpdo_late,         ///< RPDOs reach it `delay_ns` later
  rpdo_corrupted,    ///< RPDOs reach it with bits of `value` flipped in their first eight bytes
  sdo_silent,        ///< requests are not answered
  sdo_late,          ///< requests are answered `delay_ns` later
  sdo_abort,         ///< requests to `index` (0: any) are answered with `abort`
  stuck_state,       ///< the state machine does not leave `state`
  frozen,            ///< the whole device stands still, mechanics and all
  encoder_loss,      ///< the encoder repeats its last position; the drive does not notice
  emcy,              ///< sends emergency `error_code` and falls into a fault with it
  emcy_only,         ///< sends emergency `error_code` and works on (a warning)
  over_current,      ///< 2310h
  encoder_fault,     ///< 7305h
  encoder_jump,      ///< the encoder says `value` counts more from now on
  following_error,   ///< 8611h
  over_temperature,  ///< 4310h
  under_voltage,     ///< 3220h
  reset,             ///< the device restarts as after power-on
};

/// "silent", "over_current" ...; nullopt for an unknown word. Not real-time safe.
std::optional<DriveFaultKind> drive_fault_kind(std::string_view name) noexcept;
std::string_view name_of(DriveFaultKind kind) noexcept;

/// One fault with its parameters; those that the kind does not name are ignored.
struct DriveFault {
  DriveFaultKind kind = DriveFaultKind::silent;
  image::Nanoseconds duration_ns = 0;  ///< of a lasting fault; 0: until cleared
  image::Nanoseconds delay_ns = 0;
  std::uint32_t every = 1;
  std::uint32_t number = 0;  ///< of a TPDO or RPDO, 1-4; 0: any
  std::int64_t value = 0;
  std::uint16_t error_code = 0x1000;
  std::uint16_t index = 0;
  canopen::AbortCode abort = canopen::AbortCode::general_error;
  image::DriveState state = image::DriveState::switched_on;
};

}  // namespace servogate::mock
