// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

  /// The object that a word means: INDEX[:SUB], or its name without regard to case, blanks and signs, as far
  /// as it is the beginning of one name alone; "value" at the end may be left out: "statusword",
  /// "position_actual", "software-position-limit:2". nullopt: none or several, names of which are in
  /// `similar` where it is given.
  std::optional<ObjectAddress> address(std::string_view word,
                                       std::vector<std::string>* similar = nullptr) const;

 private:
  const Eds* eds_;
};

}  // namespace servogate::canopen
