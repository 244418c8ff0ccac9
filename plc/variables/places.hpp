// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/packets.hpp"
#include "plc/types/type.hpp"

namespace servogate::plc {

/// The place of a packet that a name outside of any program means: a direct address (`%QX0.0`), a symbol of
/// the machine, without case, or an address of the NC (`SA16`). nullopt: nothing. Whether a packet has it is
/// not looked at. Not real-time safe.
std::optional<image::Place> place_of(std::span<const image::Symbol> symbols, std::string_view name);

/// Type that a place of a packet has as a number; nullptr: characters.
const Type* number_type(const TypeTable& types, image::Format format);
/// The same as a bit string, as which `%MW8` has other literals; nullptr: characters.
const Type* bit_string_type(const TypeTable& types, image::Format format);

}  // namespace servogate::plc
