// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// Why a line is no request: a sentence of says:: and its arguments.
struct FormProblem {
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  text::Language language = text::user_language();  ///< that the request asks for, as far as it can be read
};

/// Language that a request asks for by `language`; without it the control's own.
text::Language language_of(const nlohmann::json& request);

/// Deepest nesting of a request: the object, a list in it, and one to spare.
inline constexpr int kDeepestRequest = 3;

/// A line of the control socket as a JSON object each of whose known fields has its JSON type (`cmd` is
/// there); nullopt: `problem` says which has not. Fields that no command knows are left alone. Never throws.
std::optional<nlohmann::json> read_request(std::string_view line, FormProblem& problem);

}  // namespace servogate::gateway
