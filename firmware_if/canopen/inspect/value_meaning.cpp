// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/value_meaning.hpp"

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/inspect/device_words.hpp"
#include "firmware_if/canopen/master/events/bus_event.hpp"

namespace servogate::canopen {

std::string meaning_of(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> bytes,
                       text::Language language) {
  if (subindex != 0) return {};
  // The second to eighth axis: CiA 402-1, "Multiple axes".
  if (index >= 0x6800 && index < 0xA000)
    index = static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  const std::uint64_t value = load_le(bytes);
  switch (index) {
    case object::kDeviceType:
      return bytes.size() == 4
                 ? text::in_language(device_type_words(static_cast<std::uint32_t>(value)), language)
                 : std::string{};
    case object::kStatusword:
      return bytes.size() == 2 ? describe_statusword(static_cast<std::uint16_t>(value), language)
                               : std::string{};
    case object::kErrorCode:
      return bytes.size() == 2 && value != 0
                 ? describe_error_code(static_cast<std::uint16_t>(value), nullptr, language)
                 : std::string{};
    case object::kModesOfOperation:
    case object::kModesOfOperationDisplay:
      return bytes.size() == 1 ? short_name(static_cast<OperationMode>(static_cast<std::int8_t>(value)))
                               : std::string{};
    case object::kSupportedDriveModes:
      return bytes.size() == 4 ? drive_modes(static_cast<std::uint32_t>(value)) : std::string{};
    default:
      return {};
  }
}

}  // namespace servogate::canopen
