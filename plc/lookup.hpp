// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plc/engine.hpp"

namespace servogate::plc {

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
