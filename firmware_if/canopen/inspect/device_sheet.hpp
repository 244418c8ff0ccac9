// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/canopen/inspect/object_walk.hpp"

/// Data sheets (EDS) of devices that have none. Not real-time safe.
namespace servogate::canopen {

/// What the file says of itself.
struct SheetOrigin {
  std::string file;                ///< its name, without folder
  std::string date, time;          ///< as CiA 306 has them: "11-25-2026", "03:04PM"
  std::string command;             ///< what has written it
  NodeId node = 0;                 ///< of the device; values that follow from it are written with $NODEID
  std::uint32_t bit_rate = 0;      ///< of the bus, bit/s
  std::vector<IndexRange> ranges;  ///< that were asked for; empty: what a data sheet lists
};

/// An EDS and how far it can be trusted.
struct DeviceSheet {
  Eds eds;
  int entries = 0;                    ///< indices and sub-indices with a value or a type of their own
  std::vector<std::string> guessed;   ///< "2001h:00": type by the length of the value, access unknown
  std::vector<std::string> left_out;  ///< they exist, but cannot be read, and nobody says their type
  std::vector<std::string> no_value;  ///< an EDS cannot hold their value (eds_value_text)
};

/// Reads the sub-indices behind those that sub-index 0 counts now, where it counts what is in use: PDO maps
/// and the error history. walk() does not look there. They are added to `objects`.
void read_unused_places(SdoAccess& access, NodeId node, std::vector<ReadObject>& objects,
                        const std::function<bool()>& over);

/// The EDS of a device as it was read. With a data sheet: its objects, but for those that the device says it
/// does not have, and their defaults; where it has none, the value that was read. Without one: what was
/// found, with types, access and PDO mapping of CiA 301 and CiA 402 for their objects, and by the length of
/// the value for others; DefaultValue is what was read. Commands, live values, the error history and the
/// serial number get no default from a reading. All of that is told in [Comments] of the file.
DeviceSheet sheet_of_device(const std::vector<ReadObject>& objects, const Eds* eds,
                            const SheetOrigin& origin);

/// The EDS of a simulated device, whose table of objects is known: a later row of the same place replaces an
/// earlier one, `hidden` ones are left out. Names are those of `eds` where there is one, or of the standards.
DeviceSheet sheet_of_rows(std::span<const ObjectSpec> rows, std::span<const ObjectSpec> hidden,
                          const Eds* eds, const SheetOrigin& origin);

}  // namespace servogate::canopen
