// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

/// One request, answered; null: the connection is gone.
nlohmann::json ask(SocketClient& client, const nlohmann::json& request);

/// The status with the process that the request speaks of in the place of the first.
nlohmann::json of_process(const nlohmann::json& status, const nlohmann::json& request);

/// Waits until what `request` began has ended, and gives the exit code. `status` is its answer and gets the
/// last status; null: the connection is gone. Ctrl-C stops what moves: a program is held on its path, a
/// second one ends it; homing and jogs stop; drives that are being switched on are switched off again.
int wait_for_end(SocketClient& client, const nlohmann::json& request, nlohmann::json& status);

}  // namespace servogate::gateway::command
