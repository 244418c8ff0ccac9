// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

/// Connects to the control at `socket`; when that is empty, to $SERVOGATE_SOCKET or the only control that
/// runs. `path`: where it is. The exit code; other than kDone it has been said why.
int connect_to_control(const std::string& socket, SocketClient& client, std::string& path);

/// Says that the control has closed the connection; the exit code for it.
int connection_lost(const std::string& path);

}  // namespace servogate::gateway::command
