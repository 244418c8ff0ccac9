// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "gateway/control/server/protocol/caller.hpp"
#include "gateway/control/server/protocol/plc_reply.hpp"
#include "plc/logic/logic_change.hpp"

namespace servogate::gateway {

/// Notes another program of the PLC in plc-changes.jsonl of the state directory, one JSON object a line.
/// Empty: done, or there is no directory; otherwise what went wrong.
std::string log_change(const std::string& state_path, const plc::LogicChange& change, const PlcLoaded& told,
                       const Caller& who, std::int64_t cycle);

}  // namespace servogate::gateway
