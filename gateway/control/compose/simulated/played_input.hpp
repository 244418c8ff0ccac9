// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "drivers/mock/world/world.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// What a person who plays the world asks of an input: nothing (it follows its axis or its output again), a
/// level, or a number.
using InputWish = std::variant<std::monostate, bool, double>;

/// What became of it, as a sentence.
struct PlayedInput {
  enum class Outcome {
    done,
    wrong,          ///< the point or its value is none; nothing has changed
    not_simulated,  ///< something real is behind the point
  };
  Outcome outcome = Outcome::wrong;
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  std::optional<double> value;  ///< the point's value from now on; nullopt: it follows
};

/// Plays an input of a simulated station, see mock::World::play_input(). Not real-time safe.
PlayedInput play_input(const machine::MachineConfig& machine, mock::World& world, const std::string& point,
                       const InputWish& wish);

}  // namespace servogate::gateway
