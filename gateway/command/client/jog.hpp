// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

/// Follows a jog that `request` began and `reply` accepted until its axis stands; a continuous one is kept
/// alive until Enter, Ctrl-C, the end of standard input, or its own end. The exit code: 0 it ended as asked,
/// 3 stopped by the operator, 1 by anything else. `reply` becomes what is said: `text`, `axis`, `position`,
/// `unit`, `reason`, and `status`, the last one; null: the connection is gone.
int follow_jog(SocketClient& client, const nlohmann::json& request, nlohmann::json& reply);

}  // namespace servogate::gateway::command
