// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "machine/load.hpp"

namespace servogate::gateway::command {

/// A bus as the command line names it: a url, or a bus of a machine file.
struct NamedBus {
  std::string url;
  std::uint32_t bit_rate = 0;
  std::optional<machine::LoadResult> machine;  ///< of MACHINE.toml#bus
  std::size_t index = 0;                       ///< of its buses
};

/// nullopt: the machine file is wrong or has no such bus, which was said (exit code kWrongUse). `bit_rate` is
/// that of a bus named by its url.
std::optional<NamedBus> named_bus(const std::string& name, double bit_rate);

}  // namespace servogate::gateway::command
