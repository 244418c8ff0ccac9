// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/force_setting.hpp"

#include "gateway/cli/messages.hpp"

namespace servogate::gateway::command {

namespace {
const text::Entry kBadSetting{"plc-force.setting", "'{0}' is not of the form NAME=VALUE",
                              "«{0}» не имеет вида ИМЯ=ЗНАЧЕНИЕ"};
}  // namespace

std::optional<std::vector<report::ForceEntry>> force_settings(const std::vector<std::string>& words) {
  std::vector<report::ForceEntry> out;
  for (const std::string& s : words) {
    const std::size_t equal = s.find('=');
    if (equal == std::string::npos || equal == 0 || equal + 1 == s.size()) {
      complain(kBadSetting, {s});
      return std::nullopt;
    }
    out.push_back({s.substr(0, equal), s.substr(equal + 1)});
  }
  return out;
}

}  // namespace servogate::gateway::command
