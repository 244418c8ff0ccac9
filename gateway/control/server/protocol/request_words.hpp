// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/control/server/protocol/caller.hpp"

namespace servogate::gateway {

/// What is said of the words of a command.
inline constexpr text::Entry kBadNumber{"client.bad-number", "'{0}' is not {1}", "«{0}» — не {1}"};
inline constexpr text::Entry kComma{"client.decimal-comma", "'{0}' has a decimal comma; write {1}",
                                    "в «{0}» десятичная запятая; пишите {1}"};

/// A finite number at the front of `text`; `rest`: what is behind it.
bool parse_number(std::string_view text, double& value, std::string_view& rest);

/// The fields of a request (docs/control-socket.md) whose `cmd` is there, from the words behind the name of
/// the command, as the command line and scenarios have them: "X +1mm", "on". False: `problem` says what is
/// wrong.
bool add_words(nlohmann::json& request, const std::vector<std::string>& arguments, FormProblem& problem);

}  // namespace servogate::gateway
