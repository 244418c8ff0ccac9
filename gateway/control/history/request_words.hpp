// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "firmware_if/image/request.hpp"
#include "gateway/control/history/event_log.hpp"
#include "machine/config.hpp"

namespace servogate::gateway::history {

/// Whether the history keeps a request of this kind: what a person or a program asked for; keep-alives and
/// what the PLC does in each scan it does not.
bool kept(image::RequestKind kind) noexcept;

/// Who asked for what, and what the gate said. `kept(request.kind)`.
Event request_event(const image::Request& request, const image::Answer& answer,
                    const machine::MachineConfig& machine, double machine_s);

}  // namespace servogate::gateway::history
