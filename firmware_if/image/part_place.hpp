// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::image {

/// A part of a device, for alarms of it and alarms that last while it is gone: a drive or a module on a bus,
/// a unit on a line. Only its device and the words for people know what the numbers mean.
struct PartPlace {
  std::int16_t device = -1;  ///< index of the bus among the machine's; -1: none
  std::int16_t part = -1;    ///< by the device's own counting (a node-ID); -1: the device as a whole
  bool operator==(const PartPlace&) const = default;
};

}  // namespace servogate::image
