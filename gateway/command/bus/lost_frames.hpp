// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/compose/can_transport.hpp"
#include "gateway/control/compose/control.hpp"

/// A command whose bus lost frames on this computer has shown nothing: that is trouble of the computer
/// (kInfrastructure), never a result. One place for all commands that have a bus.
namespace servogate::gateway::command {

/// At the end of a command: kInfrastructure when this bus, or one of this control, lost frames, which is
/// said; otherwise `code`. `bus`: as people know it.
int unless_frames_lost(int code, const std::string& bus, const image::CanBus& transport);
int unless_frames_lost(int code, const Control& control);

}  // namespace servogate::gateway::command
