// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "gateway/command/canopen/bus/tool_bus.hpp"

namespace servogate::gateway::command {

/// A frame in words, as the standard's connection set has it: "SYNC (080h)", "RPDO 1 of node 5 (205h)"; in
/// both languages (text::both).
std::string frame_words(const image::CanFrame& frame);
/// Whether only a master sends such a frame: NMT, SYNC, TIME, RPDOs, SDO requests, layer setting, guarding.
bool shows_master(const image::CanFrame& frame);

/// Listens for `listening`; the first frame that shows that somebody controls this bus. nullopt: it is idle.
std::optional<image::CanFrame> foreign_master(ToolBus& bus, image::Nanoseconds listening);

/// Whether writing this object can move a drive, release its brake or start its program: the set-points,
/// controlword and modes of every axis of CiA 402, its outputs 60FEh, outputs of CiA 401 (6200h to 63FFh,
/// 6410h to 641Fh), and NMT requests 1F82h.
bool can_move(std::uint16_t index);

/// The gate of everything that can move. kDone: it may be done; otherwise the exit code, after saying why
/// not: kWrongUse without `--i-may-move`, kAlarm when somebody controls the bus.
int may_move(ToolBus& bus, const std::string& what, bool i_may_move, double listen_s);
/// The half of it for what moves nothing and yet disturbs a bus that is in use.
int must_be_idle(ToolBus& bus, const std::string& what, double listen_s);

}  // namespace servogate::gateway::command
