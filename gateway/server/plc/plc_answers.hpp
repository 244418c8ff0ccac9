// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/options.hpp"

/// What the two halves of PlcDesk answer in the same way.
namespace servogate::gateway::plc_answers {

inline const text::Entry kNoVariable{"plc.no-variable", "there is no variable or place '{0}'",
                                     "переменной или места «{0}» нет"};

inline nlohmann::json told(const text::Entry& entry, const std::vector<std::string>& arguments,
                           text::Language language) {
  return {{"ok", true}, {"exit", kDone}, {"text", text::render(entry, arguments, language)}};
}
inline nlohmann::json refused(const text::Entry& entry, const std::vector<std::string>& arguments, int exit,
                              text::Language language) {
  return {
      {"ok", false}, {"code", entry.id}, {"text", text::render(entry, arguments, language)}, {"exit", exit}};
}

}  // namespace servogate::gateway::plc_answers
