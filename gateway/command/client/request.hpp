// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

/// The request of a client's command line (docs/control-socket.md); null: wrong use, which has been said.
nlohmann::json request_of(const ClientOptions& options);

}  // namespace servogate::gateway::command
