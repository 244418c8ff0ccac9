// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {

/// Reads the fields of one section, with a warning for each that is odd.
class EdsFieldReader {
 public:
  EdsFieldReader(const IniSection& section, EdsFindings& findings) : section_(section), findings_(findings) {}

  /// A number of the section; nullopt when there is none or it is empty.
  std::optional<EdsNumber> number(std::string_view key) const;
  std::int64_t integer(std::string_view key, std::int64_t otherwise) const;
  bool boolean(std::string_view key) const;
  std::string text(std::string_view key) const { return std::string(section_.find(key)); }

  /// Everything of an index or sub-index. `inherited`: data type where the section has none (0: none).
  EdsEntry entry(bool top, std::uint16_t inherited_type = 0) const;
  /// A value of this data type; nullopt when there is none or it does not fit.
  std::optional<EdsValue> value(std::string_view key, std::uint16_t data_type) const;
  /// A value of a DCF for `e`, whose other fields are there: empty, it is the empty string, where its type
  /// has one. One that is to be written and cannot be is an error.
  std::optional<EdsValue> parameter(std::string_view key, const EdsEntry& e) const;

 private:
  EdsObjectType object_type() const;
  std::uint16_t data_type(std::uint16_t inherited) const;
  EdsAccess access() const;
  std::optional<EdsValue> real(const IniEntry& field) const;
  EdsValue text_or_bytes(const IniEntry& field, std::uint16_t data_type, bool to_be_written) const;
  bool fits(EdsNumber& number, std::uint16_t data_type, const IniEntry& field) const;
  void drop_wrong_limits(EdsEntry& entry) const;

  const IniSection& section_;
  EdsFindings& findings_;
};

}  // namespace servogate::canopen
