// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/request.hpp"
#include "gateway/control/server/protocol/reply.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// What the gate has refused, with its place in the units that people use.
Reply refused_by_gate(image::Answer answer, const machine::MachineConfig& machine, text::Language language);

}  // namespace servogate::gateway
