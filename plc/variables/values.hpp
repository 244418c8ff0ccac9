// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "plc/types/type.hpp"

namespace servogate::plc {

/// A variable in memory as JSON: true, -5, 1.25, "T#30ms", "text", enumerations by name, arrays and
/// structures as such; text as UTF-8, half a surrogate pair of a WSTRING as $D83D. `bit` >= 0: that bit of
/// the byte. Not real-time safe.
std::string to_json(const Type& type, const std::uint8_t* at, int bit = -1);

/// Reads an IEC literal, the name of an enumeration value, or plain text for a STRING, into the bytes of an
/// elementary type. False, and nothing written, when the text is no value of that type. Not real-time safe.
bool parse_value(const Type& type, std::string_view text, std::uint8_t* out);

/// The value of an elementary variable in the form that parse_value reads. Not real-time safe.
std::string to_literal(const Type& type, const std::uint8_t* at);

/// Numeric value (times in nanoseconds), NaN for text and compound types. real-time safe.
double to_number(const Type& type, const std::uint8_t* at) noexcept;
/// Stores a number; false when it does not fit the type. real-time safe.
bool from_number(const Type& type, double value, std::uint8_t* out) noexcept;

}  // namespace servogate::plc
