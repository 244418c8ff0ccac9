// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "gateway/control/server/protocol/caller.hpp"
#include "gateway/control/server/protocol/command.hpp"

namespace servogate::gateway {

/// What a line of the control socket says.
struct ReadRequest {
  std::string name;  ///< of the command
  ask::Command command;
  image::Asker asker = image::Asker::command_line;
  text::Language language = text::user_language();
};

/// Deepest nesting of a request: the object, a list in it, and one to spare.
inline constexpr int kDeepestRequest = 3;

/// Reads a line of the control socket: a JSON object whose fields have their types and whose command is
/// known, by somebody who may ask here; nullopt: `problem` says what is wrong. Fields that no command knows
/// are left alone. Never throws on what stands in the line.
std::optional<ReadRequest> read_request(std::string_view line, FormProblem& problem);

}  // namespace servogate::gateway
