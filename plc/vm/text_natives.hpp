// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "plc/vm/machine.hpp"

namespace servogate::plc::vm {

/// Numbers of the string functions begin here.
inline constexpr std::uint16_t kTextBase = 300;
/// Number of a string function.
std::uint16_t text_function(ir::Native n, bool wide) noexcept;
/// To and from text depend on the type, not only on its cell; `wide`: of or to a WSTRING.
std::uint16_t to_text_function(const Type& from, bool wide) noexcept;
std::uint16_t from_text_function(const Type& from, const Type& to) noexcept;
/// real-time safe.
NativeFunction text_native(std::uint16_t number) noexcept;

}  // namespace servogate::plc::vm
