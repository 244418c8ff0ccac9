// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// The commands as they are declared to the parser, read back for whoever writes them down: help pages,
/// completion. Not real-time safe.
namespace servogate::gateway {

/// The commands below `app`, in the order in which they were declared.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// "servogate play" without the program's name: "play", "can bus"; empty for the program itself.
std::string command_path(const CLI::App& app);

/// The options with a name (`--json`), without those of the parser's own.
std::vector<const CLI::Option*> options_of(const CLI::App& app);
/// "--quiet", of "-q,--quiet" the longer one.
std::string option_name(const CLI::Option& option);
/// Whether the option wants a value.
bool takes_value(const CLI::Option& option);
/// The words that one_of() allows as value; empty: anything.
std::vector<std::string> choices_of(const CLI::Option& option);

/// The positional arguments in their order.
std::vector<const CLI::Option*> arguments_of(const CLI::App& app);

}  // namespace servogate::gateway
