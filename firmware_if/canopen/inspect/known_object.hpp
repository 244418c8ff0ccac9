// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {

/// What is known of an object without a data sheet: the standard's own objects, by their type there.
struct KnownObject {
  std::uint16_t data_type = 0;  ///< 0: not known
  bool writable = true;
  bool readable = true;
  bool mappable = false;
};
/// The row of CiA 301 or CiA 402 for a place; nullopt: none is known. Not real-time safe.
std::optional<KnownObject> known_object(std::uint16_t index, std::uint8_t subindex);
/// Of an object with sub-indices: an array where the standard says so, otherwise a record. Source: CiA
/// 301, 7.5.1.
EdsObjectType known_container(std::uint16_t index) noexcept;

}  // namespace servogate::canopen
