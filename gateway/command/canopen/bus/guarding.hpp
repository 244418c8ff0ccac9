// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <span>

#include "firmware_if/canopen/301/nmt.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"

namespace servogate::gateway::command {

/// Whether the state of a node may be asked for by node guarding: it sends no heartbeat, and a remote request
/// does not start its life guarding (100Ch and 100Dh, read by SDO). Source: CiA 301, 7.2.8.3.2.
bool may_guard(ToolBus& bus, canopen::NodeId node);
/// Asks each once; who does not answer within 50 ms of the last question is not in the result.
std::map<canopen::NodeId, canopen::NmtState> guard(ToolBus& bus, std::span<const canopen::NodeId> nodes);
/// An object as an unsigned number; nullopt: it cannot be read.
std::optional<std::uint32_t> number_of(SdoAccess& access, canopen::NodeId node, std::uint16_t index,
                                       std::uint8_t subindex);

}  // namespace servogate::gateway::command
