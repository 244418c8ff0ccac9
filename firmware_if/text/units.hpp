// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::text {

/// A unit as people read it, as an argument of a sentence in both languages (both()): "mm/s" gives "mm/s" and
/// "мм/с". One that the table lacks stays as it is. Files, JSON and command lines keep the English symbols.
/// Not real-time safe.
std::string unit_words(std::string_view symbol);

/// The symbol of a unit that a person wrote in either language: "мм" and "mm" give "mm". One that the table
/// lacks stays as it is. Not real-time safe.
std::string unit_symbol(std::string_view words);

}  // namespace servogate::text
