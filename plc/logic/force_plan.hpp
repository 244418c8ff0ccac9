// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/request.hpp"
#include "plc/engine/engine.hpp"

namespace servogate::plc {

/// What it takes to hold a variable or a place of a packet at a value: the same for every client and for
/// `servogate run`. Not real-time safe, as all of this header.
struct ForcePlan {
  enum class Kind : std::uint8_t {
    places,    ///< `requests`, all of them or none
    variable,  ///< of the program: a LogicChange
    unknown,   ///< no such variable or place
    no_value,  ///< of this variable or place
  };
  Kind kind = Kind::unknown;
  std::vector<image::Request> requests;
};
/// `symbols` of the machine; `program`: nullptr without a PLC. Of a variable of the program the value is
/// looked at as well.
ForcePlan plan_force(std::span<const image::Symbol> symbols, const Engine* program, const std::string& name,
                     const std::string& value);

/// The place of a packet that a name means: of the program's variable there, a point of the machine, or an
/// address. nullopt: a variable of the program alone, or nothing.
std::optional<image::Place> place_of(std::span<const image::Symbol> symbols, const Engine* program,
                                     const std::string& name);

}  // namespace servogate::plc
