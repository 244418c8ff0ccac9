// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace servogate::gateway {

/// Says that a word is no command, and which one was probably meant. `prefix`: "plc " for its subcommands.
void complain_of_command(const std::string& prefix, const std::string& word, const CLI::App& app);

/// Says in the user's language what CLI11 has found wrong, naming the option or argument. `unread`: what it
/// could not place, in the order of the command line.
void complain_of_use(const CLI::ParseError& error, const CLI::App& app,
                     const std::vector<std::string>& unread);

/// True, and said: an argument was given that has no characters.
bool complain_of_empty(const CLI::App& app);

}  // namespace servogate::gateway
