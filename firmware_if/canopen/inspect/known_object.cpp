// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/known_object.hpp"

#include <algorithm>

#include "firmware_if/canopen/device/drive/drive_objects.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"

namespace servogate::canopen {

namespace {

const std::vector<ObjectSpec>& standard_rows() {
  static const std::vector<ObjectSpec> rows = [] {
    std::vector<ObjectSpec> all = communication_objects(1, {});
    const auto drive = drive_objects({});
    all.insert(all.end(), drive.begin(), drive.end());
    return all;
  }();
  return rows;
}

/// Ranges in which every object is built like its first: SDO and PDO parameters.
std::uint16_t first_of_its_kind(std::uint16_t index) {
  for (const std::uint16_t first : {0x1400, 0x1600, 0x1800, 0x1A00})
    if (index >= first && index < first + 0x200) return first;
  if (index >= 0x1200 && index < 0x1280) return 0x1200;
  // The second to eighth axis of a drive. Source: CiA 402-1, "Multiple axes".
  if (index >= 0x6800 && index < 0xA000) return static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  return index;
}

}  // namespace

std::optional<KnownObject> known_object(std::uint16_t index, std::uint8_t subindex) {
  // 2000h-5FFFh belong to the manufacturer, also where our own simulated drive has something there.
  if (index >= 0x2000 && index < 0x6000) return std::nullopt;
  const std::uint16_t kind = first_of_its_kind(index);
  const auto& rows = standard_rows();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ObjectSpec& s) {
    return s.index == kind && s.subindex == subindex;
  });
  if (found == rows.end()) return std::nullopt;
  KnownObject known;
  known.data_type = static_cast<std::uint16_t>(found->type);
  known.writable = found->access == Access::rw || found->access == Access::wo;
  known.readable = found->access != Access::wo;
  known.mappable = found->mappable != Mappable::no;
  return known;
}

EdsObjectType known_container(std::uint16_t index) noexcept {
  for (const std::uint16_t array : {0x1003, 0x1010, 0x1011, 0x1016, 0x1028, 0x1029})
    if (index == array) return EdsObjectType::array;
  return EdsObjectType::record;
}

}  // namespace servogate::canopen
