// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace servogate::machine {

/// `text` as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD.
std::string json_string(std::string_view text);
/// Length of the well-formed UTF-8 sequence at the front of a text that is not empty, 0: none. Source: RFC
/// 3629.
std::size_t utf8_sequence(std::string_view text);
/// A number in the shortest form that reads back; what is not finite becomes null.
std::string json_number(double value);

}  // namespace servogate::machine
