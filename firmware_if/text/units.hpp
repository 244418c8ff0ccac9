// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::text {

/// A unit as people read it, as an argument of a sentence in both languages (both()): "mm/s" gives "mm/s" and
/// "мм/с". One that the table lacks stays as it is. Files, JSON and command lines keep the English symbols.
/// Not real-time safe.
std::string unit_words(std::string_view symbol);

}  // namespace servogate::text
