// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What several clients say of the words of their command.
namespace servogate::gateway::command {

inline constexpr text::Entry kBadNumber{"client.bad-number", "'{0}' is not {1}", "«{0}» — не {1}"};
inline constexpr text::Entry kComma{"client.decimal-comma", "'{0}' has a decimal comma; write {1}",
                                    "в «{0}» десятичная запятая; пишите {1}"};

}  // namespace servogate::gateway::command
