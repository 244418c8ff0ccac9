// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/control/server/protocol/reply.hpp"

namespace servogate::gateway {

/// A reply as docs/control-socket.md has it: one JSON object without a line end. What is no UTF-8 is
/// replaced.
std::string line_of(const Reply& reply);
/// The symbols alone, as `servogate plc list --json` prints them.
std::string line_of(const PlcSymbols& symbols);

}  // namespace servogate::gateway
