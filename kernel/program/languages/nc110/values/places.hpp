// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "firmware_if/image/packets.hpp"

namespace servogate::program::nc110 {

/// True where the name of a place begins: SA, SK or SYVAR.
bool names_place(std::string_view text);
/// A place at `pos` of a line; moves behind it. Throws ProgramError when it is none.
image::Place read_place(std::string_view line, std::size_t& pos);
/// True when the text names a place of SA or SK outside of quotes from `pos` on.
bool names_signal(std::string_view text, std::size_t pos);

}  // namespace servogate::program::nc110
