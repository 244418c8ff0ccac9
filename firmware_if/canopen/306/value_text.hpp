// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Values of objects as people and data sheets write them. Not real-time safe.
namespace servogate::canopen {

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
/// Type by the number of bytes alone, unsigned; text where it is printable.
const ValueType* guess_type(std::span<const std::uint8_t> bytes);

bool is_text(const ValueType& type);
/// Shown and written byte by byte: OCTET_STRING, DOMAIN, and what has no number of its own.
bool is_bytes(const ValueType& type);

/// Bytes of a value as a person writes it; nullopt: no value of this type.
std::optional<std::vector<std::uint8_t>> encode_value(std::string_view text, const ValueType& type);
/// False: a number of this type has another length. Texts and bytes have any.
bool may_be(std::span<const std::uint8_t> bytes, const ValueType& type);
/// The number of a REAL32 or REAL64.
double real_of(std::span<const std::uint8_t> bytes);
std::int64_t signed_of(std::span<const std::uint8_t> bytes);
/// A text as UTF-8, up to its first zero; bytes that are no UTF-8 are Latin-1, as in data sheets.
std::string text_of(std::span<const std::uint8_t> bytes);
/// The value in words: "567 (0237h)", "-5", "\"name\"", "DE AD". Bytes that do not fit the type are shown as
/// bytes.
std::string show_value(std::span<const std::uint8_t> bytes, const ValueType* type);
/// "DEAD": the bytes in the order of the wire.
std::string hex_text(std::span<const std::uint8_t> bytes, const char* between = "");
/// The value as an EDS or DCF has it: "0x1234", "-5", text, bytes in hexadecimal. nullopt: a text that a line
/// of such a file cannot hold (control characters, blanks at an end, Latin-1): read back it would be another
/// one; and no bytes at all where the type is no string. What it gives is read back to the byte as a
/// ParameterValue, but for zeros at the end of a text.
std::optional<std::string> eds_value_text(std::span<const std::uint8_t> bytes, std::uint16_t data_type);

}  // namespace servogate::canopen
