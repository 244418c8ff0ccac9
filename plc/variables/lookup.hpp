// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::plc {

struct Image;
struct Type;

/// A variable found by name. Valid as long as the Image it came from. `type` is never null in a handle that
/// Engine::find gave.
struct Handle {
  std::uint32_t address = 0;  ///< byte in the engine's memory
  std::int32_t place = -1;    ///< index of the packet place it mirrors, -1: none
  std::int8_t bit = -1;       ///< bit in that byte, -1: the whole variable
  const Type* type = nullptr;
};

/// The variable that a path names in a compiled program; see Engine::find. Not real-time safe.
std::optional<Handle> find_variable(const Image& image, std::string_view path);
/// A path of the variable at an address, empty when there is none. Not real-time safe.
std::string variable_name(const Image& image, const Handle& handle);
/// A value as JSON, as to_json; a reference as the name of the variable that it leads to, or NULL. Not
/// real-time safe.
std::string value_text(const Image& image, const Type& type, const std::uint8_t* at, int bit = -1);
/// Every variable that belongs to a program itself, and the places it uses, as paths. Not real-time safe.
std::vector<std::string> variable_names(const Image& image);

}  // namespace servogate::plc
