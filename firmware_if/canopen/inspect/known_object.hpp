// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

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

}  // namespace servogate::canopen
