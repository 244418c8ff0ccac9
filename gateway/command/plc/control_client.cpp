// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/plc/control_client.hpp"

#include <cstdio>

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/client/connection.hpp"
#include "gateway/command/client/wait.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

int ControlClient::connect(const std::string& socket) { return connect_to_control(socket, client_, path_); }

json ControlClient::ask(const std::string& command, json more) {
  more["cmd"] = command;
  more["language"] = text::user_language() == text::Language::russian ? "ru" : "en";
  json answer = command::ask(client_, more);
  if (answer.is_null()) connection_lost(path_);
  return answer;
}

int ControlClient::tell(const json& answer, bool as_json) {
  if (answer.is_null()) return kInfrastructure;
  if (as_json)
    print_exact(answer.dump(-1, ' ', false, json::error_handler_t::replace));
  else if (!answer.value("ok", false))
    gateway::tell("servogate: " + answer.value("text", "") + " [" + answer.value("code", "") + "]");
  return answer.value("exit", static_cast<int>(kInfrastructure));
}

}  // namespace servogate::gateway::command
