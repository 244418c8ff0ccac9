// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "machine/keys/document.hpp"

/// Small TOML files beside a command: gains, limits. Not real-time safe.
namespace servogate::gateway::command {

/// Reads one. nullopt: it cannot be read or is no TOML, which has been said with its line.
std::optional<machine::Document> read_toml(const std::string& path);
/// Says what is wrong with a line of it.
std::nullopt_t wrong_line(const std::string& path, int line, const text::Entry& entry,
                          const std::vector<std::string>& arguments);

}  // namespace servogate::gateway::command
