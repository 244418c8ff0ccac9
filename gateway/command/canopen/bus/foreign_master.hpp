// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>

#include "gateway/command/canopen/bus/tool_bus.hpp"

namespace servogate::gateway::command {

/// Listens for `listening`; the first frame that shows that somebody controls this bus. nullopt: it is idle.
std::optional<image::CanFrame> foreign_master(ToolBus& bus, image::Nanoseconds listening);

/// Whether writing this object can move a drive, release its brake or start its program: the set-points,
/// controlword and modes of every axis of CiA 402, its outputs 60FEh, outputs of CiA 401 (6200h to 63FFh,
/// 6410h to 641Fh), and NMT requests 1F82h.
bool can_move(std::uint16_t index);

/// Writing this takes the torque away and brings none: a controlword (6040h of any axis) whose command is
/// Disable voltage or Quick stop (CiA 402-2, device control). It waits for nothing and needs no permission.
bool takes_energy_away(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data);

/// The gate of every command that only reads. kDone: the bus shows no master, or --anyway was said; otherwise
/// kAlarm, after saying what was heard: SDO requests of two clients disturb one another.
int may_read(ToolBus& bus, const CanopenBusOptions& options);
/// The gate of everything that can move. kDone: it may be done; otherwise the exit code, after saying why
/// not: kWrongUse without `--i-may-move`, kAlarm when somebody controls the bus.
int may_move(ToolBus& bus, const std::string& what, const CanopenBusOptions& options);
/// The half of it for what moves nothing and yet disturbs a bus that is in use: every write.
int must_be_idle(ToolBus& bus, const std::string& what, const CanopenBusOptions& options);

}  // namespace servogate::gateway::command
