// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/306/value_text.hpp"

namespace servogate::canopen {

/// Names and types of objects: of a data sheet where there is one, otherwise of the standards. Not
/// real-time safe.
class ObjectCatalogue {
 public:
  /// `eds` must live longer; nullptr: the standards alone.
  explicit ObjectCatalogue(const Eds* eds = nullptr) : eds_(eds) {}
  /// "Statusword", "Identity object: Vendor-ID"; empty: not known.
  std::string name(std::uint16_t index, std::uint8_t subindex) const;
  /// nullptr: not known.
  const ValueType* type(std::uint16_t index, std::uint8_t subindex) const;

 private:
  const Eds* eds_;
};

}  // namespace servogate::canopen
