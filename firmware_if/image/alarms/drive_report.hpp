// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "firmware_if/image/detail.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::image {

/// What a drive or another CANopen device reports of itself, as the detail of a notice.
struct DriveReport {
  static constexpr DetailKind kDetail = DetailKind::drive_report;
  std::uint16_t statusword = 0;    ///< of CiA 402; 0: none
  std::uint16_t error_code = 0;    ///< of CiA 301, "emergency error codes", or the maker's; 0: none
  std::uint16_t object_index = 0;  ///< the object that is meant; 0: none
  std::uint16_t object_subindex = 0;
};

/// A CiA 402 status word in words, e.g. `0x0218 fault, warning`. Not real-time safe.
std::string statusword_text(std::uint16_t statusword, text::Language language);
/// The name of a state (image::DriveState), `?` of none. Not real-time safe.
std::string_view drive_state_text(int state, text::Language language);
/// "0x1018:02". Not real-time safe.
std::string object_text(std::uint16_t index, std::uint16_t subindex);
/// "0x0218": so many hexadecimal digits. Not real-time safe.
std::string hex_text(unsigned value, int digits);

}  // namespace servogate::image
