// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "plc/vm/machine.hpp"

namespace servogate::plc::vm {

/// Numbers of the string functions begin here.
inline constexpr std::uint16_t kTextBase = 300;
/// real-time safe.
NativeFunction text_native(std::uint16_t number) noexcept;

/// A STRING in memory: one byte of length, then the characters.
inline std::string_view text_at(const std::uint8_t* p) noexcept {
  return {reinterpret_cast<const char*>(p + 1), *p};
}

}  // namespace servogate::plc::vm
