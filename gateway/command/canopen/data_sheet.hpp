// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "firmware_if/canopen/306/eds.hpp"
#include "gateway/command/canopen/object_value.hpp"

namespace servogate::gateway::command {

/// Reads an EDS or DCF and prints what is odd about it. nullopt: it cannot be read or has no objects, which
/// has been said (exit code kWrongUse).
std::optional<canopen::Eds> read_data_sheet(const std::string& path);

/// Names and types of objects: of a data sheet where there is one, otherwise of the standards.
class ObjectCatalogue {
 public:
  /// `eds` must live longer; nullptr: the standards alone.
  explicit ObjectCatalogue(const canopen::Eds* eds = nullptr) : eds_(eds) {}
  /// "Statusword", "Identity object: Vendor-ID"; empty: not known.
  std::string name(std::uint16_t index, std::uint8_t subindex) const;
  /// nullptr: not known.
  const ValueType* type(std::uint16_t index, std::uint8_t subindex) const;

 private:
  const canopen::Eds* eds_;
};

}  // namespace servogate::gateway::command
