// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"

namespace servogate::canopen {

/// What a device says of itself in 1000h, 1018h and 1008h.
struct DeviceIdentity {
  std::uint32_t device_type = 0;
  std::uint32_t vendor_id = 0, product_code = 0, revision = 0, serial_number = 0;
  std::string_view name;  ///< outlives the dictionary; at most 64 characters
};

/// The rows 1000h-1FFFh of a device with four PDOs of each direction; PDO 1 is valid with the given mapping
/// word, the others exist and are switched off. Not real-time safe.
std::vector<ObjectSpec> communication_objects(NodeId node, const DeviceIdentity& identity);

}  // namespace servogate::canopen
