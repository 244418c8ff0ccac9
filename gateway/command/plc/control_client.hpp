// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

/// The PLC of the running control, as its clients ask it.
class ControlClient {
 public:
  /// The exit code; other than kDone it has been said why.
  int connect(const std::string& socket);
  /// `{"cmd":command, ...more}` answered; null: the connection is gone, which has been said.
  nlohmann::json ask(const std::string& command, nlohmann::json more = nlohmann::json::object());
  /// Prints a refusal, or with `json` the answer itself. The exit code of the answer.
  static int tell(const nlohmann::json& answer, bool json);

 private:
  SocketClient client_;
  std::string path_;
};

}  // namespace servogate::gateway::command
