// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/inspect/sdo_access.hpp"

namespace servogate::canopen {

/// An object as the node has it.
struct ReadObject {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  SdoOutcome outcome;
  bool record = false;  ///< one of several sub-indices
};

/// Indices from first to last.
struct IndexRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
};

/// Reads what a data sheet lists: neither what can only be written, nor domains, nor what the sheet excludes
/// from a scan (ObjFlags bit 1). Refusals are among the results.
std::vector<ReadObject> read_listed(SdoAccess& access, NodeId node, const Eds& eds,
                                    const std::function<bool()>& over);
/// Finds the objects of a node without a data sheet: in `range`, or in the areas that the standards use
/// (1000h to 10FFh, SDO and PDO parameters, 1F50h to 1F9Fh, 6000h to 67FFh). What does not exist is left out.
std::vector<ReadObject> walk(SdoAccess& access, NodeId node, const std::vector<IndexRange>& ranges,
                             const std::function<bool()>& over);
std::vector<IndexRange> standard_areas();

/// A DCF of what was read: the data sheet's objects with their values as the node has them, or, without a
/// sheet, what was found with the types that the standards have or the length suggests. `not_saved` gets the
/// places whose value no DCF can hold (eds_value_text).
Eds saved_configuration(const std::vector<ReadObject>& objects, const Eds* eds, NodeId node,
                        std::uint32_t bit_rate, std::vector<std::string>& not_saved);

/// A parameter with the value that a file has for it.
struct Parameter {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::vector<std::uint8_t> wanted;
  const ValueType* type = nullptr;
  bool writable = true;
};
/// The parameters of a file: what can be written or is constant, and the identity. Not among them: values
/// that only live (ro), commands (controlword, set-points), history, save and load.
std::vector<Parameter> parameters_of(const Eds& file, NodeId node);

/// A parameter that is not as a file has it.
struct Difference {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::string wanted;  ///< value of the file
  SdoOutcome outcome;  ///< what the device answered
  const ValueType* type = nullptr;
};
/// Compares the parameters of a file with the node.
std::vector<Difference> differences(SdoAccess& access, NodeId node, const Eds& file, int& compared,
                                    const std::function<bool()>& over);

}  // namespace servogate::canopen
