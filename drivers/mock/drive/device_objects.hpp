// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"

namespace servogate::mock {

/// The object dictionary of a simulated drive, before it is built.
struct DeviceObjects {
  std::vector<canopen::ObjectSpec> rows;
  std::vector<canopen::ObjectSpec>
      hidden;  ///< rows that the simulation needs and the data sheet does not have
  std::vector<ObjectPlace>
      left_out;  ///< objects of the sheet that the simulation cannot have, in their order
};

/// The standard's objects with the values of the name plate; with a data sheet its objects instead. Texts
/// point into `config`, which must live as long as the rows are used. Not real-time safe.
DeviceObjects device_objects(const SimulatedDriveConfig& config);

}  // namespace servogate::mock
