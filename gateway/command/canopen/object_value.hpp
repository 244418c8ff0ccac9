// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::gateway::command {

/// Place of a value in an object dictionary.
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
};
/// INDEX[:SUB], hexadecimal both, with or without 0x or h: "6041", "0x1018:4", "1018h:04". nullopt: none.
std::optional<ObjectAddress> parse_address(std::string_view text);
/// "1018h:04".
std::string address_text(std::uint16_t index, std::uint8_t subindex);

/// How the bytes of an object are read and written by people: number of the data type in CiA 301, 7.4.7.
struct ValueType {
  std::string_view name;    ///< of the command line: "u16", "str"
  std::uint16_t data_type;  ///< 0: bytes as they are
};
/// Type by its word, "" and unknown ones: nullptr.
const ValueType* type_named(std::string_view word);
/// Type by its number in CiA 301; nullptr for what people can only read as bytes.
const ValueType* type_numbered(std::uint16_t data_type);
/// All words, for a message.
std::string type_words();

/// Bytes of a value as a person writes it; nullopt: no value of this type.
std::optional<std::vector<std::uint8_t>> encode_value(std::string_view text, const ValueType& type);
/// False: a number of this type has another length. Texts and bytes have any.
bool may_be(std::span<const std::uint8_t> bytes, const ValueType& type);
/// The value in words: "567 (0237h)", "-5", "\"name\"", "DE AD". Bytes that do not fit the type are shown as
/// bytes.
std::string show_value(std::span<const std::uint8_t> bytes, const ValueType* type);
/// The value for JSON: a number, a string, true or false; null where the bytes are no value of the type.
nlohmann::json json_value(std::span<const std::uint8_t> bytes, const ValueType* type);
/// "DEAD": the bytes in the order of the wire.
std::string hex_text(std::span<const std::uint8_t> bytes, const char* between = "");
/// The value as an EDS has it: "0x1234", "-5", text.
std::string eds_value_text(std::span<const std::uint8_t> bytes, std::uint16_t data_type);

/// What is known of an object without a data sheet: the standard's own objects, by their type there.
struct KnownObject {
  std::uint16_t data_type = 0;  ///< 0: not known
  bool writable = true;
  bool readable = true;
  bool mappable = false;
};
/// The row of CiA 301 or CiA 402 for a place; nullopt: none is known.
std::optional<KnownObject> known_object(std::uint16_t index, std::uint8_t subindex);
/// Type by the number of bytes alone, unsigned; text where it is printable.
const ValueType* guess_type(std::span<const std::uint8_t> bytes);

}  // namespace servogate::gateway::command
