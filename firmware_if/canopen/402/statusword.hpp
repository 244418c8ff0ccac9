// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// Bits of the statusword 6041h. Source: CiA 402-2, "Object 6041h: Statusword".
namespace statusword {
inline constexpr std::uint16_t kReadyToSwitchOn = 1u << 0, kSwitchedOn = 1u << 1, kOperationEnabled = 1u << 2,
                               kFault = 1u << 3, kVoltageEnabled = 1u << 4,
                               kQuickStop = 1u << 5,  ///< 0 = quick stop
    kSwitchOnDisabled = 1u << 6, kWarning = 1u << 7, kManufacturer8 = 1u << 8, kRemote = 1u << 9,
                               kTargetReached = 1u << 10, kInternalLimit = 1u << 11,
                               kModeSpecific12 = 1u << 12,  ///< csp/csv/cst: drive follows the command value
    kModeSpecific13 = 1u << 13,                             ///< csp/pp: following error; homing: homing error
    kManufacturer14 = 1u << 14, kManufacturer15 = 1u << 15;
}  // namespace statusword

/// State by the masks of CiA 402-2, table "State coding"; nullopt for a pattern the table does not have.
/// `offline` is never returned. real-time safe.
constexpr std::optional<image::DriveState> decode_state(std::uint16_t word) noexcept {
  using image::DriveState;
  switch (word & 0x4F) {
    case 0x00:
      return DriveState::not_ready_to_switch_on;
    case 0x40:
      return DriveState::switch_on_disabled;
    case 0x0F:
      return DriveState::fault_reaction_active;
    case 0x08:
      return DriveState::fault;
    default:
      break;
  }
  switch (word & 0x6F) {
    case 0x21:
      return DriveState::ready_to_switch_on;
    case 0x23:
      return DriveState::switched_on;
    case 0x27:
      return DriveState::operation_enabled;
    case 0x07:
      return DriveState::quick_stop_active;
    default:
      return std::nullopt;
  }
}

/// The state's own bits (0-3, 5, 6) as a drive sets them; 0 for offline. real-time safe.
constexpr std::uint16_t encode_state(image::DriveState state) noexcept {
  using image::DriveState;
  switch (state) {
    case DriveState::switch_on_disabled:
      return 0x40;
    case DriveState::ready_to_switch_on:
      return 0x21;
    case DriveState::switched_on:
      return 0x23;
    case DriveState::operation_enabled:
      return 0x27;
    case DriveState::quick_stop_active:
      return 0x07;
    case DriveState::fault_reaction_active:
      return 0x0F;
    case DriveState::fault:
      return 0x08;
    default:
      return 0;
  }
}

/// Name of a state as CiA 402-2 writes it, and in Russian. real-time safe.
const text::Entry& state_text(image::DriveState state) noexcept;

/// The statusword in words: state, then what is out of the ordinary or worth knowing in every mode, e.g.
/// "Operation enabled; warning, target reached", "Switch on disabled; no main voltage". Bits 12 and 13 depend
/// on the mode and are not told. Not real-time safe.
std::string describe_statusword(std::uint16_t word, text::Language language);

}  // namespace servogate::canopen
