// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// What the number of an object says, where it is more than a number: state of 6041h, mode of 6060h and
/// 6061h, modes of 6502h, error code 603Fh, device type 1000h; of 6041h to 6502h on every axis of CiA 402.
/// Empty: nothing, or the bytes are of another length. Not real-time safe.
std::string meaning_of(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> bytes,
                       text::Language language);

}  // namespace servogate::canopen
