// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "gateway/command/canopen/bus/tool_bus.hpp"

namespace servogate::gateway::command {

/// Listens for `listening`; the first frame that shows that somebody controls this bus. nullopt: it is idle.
std::optional<image::CanFrame> foreign_master(ToolBus& bus, image::Nanoseconds listening);

/// The gate of every command that only reads. kDone: the bus shows no master, or --anyway was said; otherwise
/// kAlarm, after saying what was heard: SDO requests of two clients disturb one another.
int may_read(ToolBus& bus, const CanopenBusOptions& options);
/// The gate of everything that can move. kDone: it may be done; otherwise the exit code, after saying why
/// not: kWrongUse without `--i-may-move`, kAlarm when somebody controls the bus.
int may_move(ToolBus& bus, const std::string& what, const CanopenBusOptions& options);
/// The half of it for what moves nothing and yet disturbs a bus that is in use: every write.
int must_be_idle(ToolBus& bus, const std::string& what, const CanopenBusOptions& options);

}  // namespace servogate::gateway::command
