// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"

namespace servogate::gateway::command {

int plc_load(const PlcLoadOptions& options) {
  using nlohmann::json;
  ControlClient control;
  if (const int code = control.connect(options.socket); code != kDone) return code;
  json files = json::array();
  for (const std::string& file : options.files) files.push_back(std::filesystem::absolute(file).string());
  const json answer = control.ask(
      "plc_load", {{"files", files}, {"online", options.online}, {"while_running", options.while_running}});
  const int code = ControlClient::tell(answer, options.json);
  if (code == kDone && !options.json) print_line(answer.value("text", ""));
  return code;
}

}  // namespace servogate::gateway::command
