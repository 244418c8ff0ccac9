// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/control/compose/can_transport.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// Opens a bus of the machine file that is not simulated, for its master. nullopt: it cannot be, which is a
/// finding at its place in the file. Not real-time safe.
std::optional<CanTransport> open_bus(const machine::MachineConfig& machine, std::size_t bus,
                                     std::vector<text::Finding>& findings);
/// True of a finding that says that a bus does not open: the computer is at fault, not the file.
bool bus_not_opened(const text::Finding& finding);

/// What of the machine's buses on the kernel's CAN interfaces would not open here; they are closed again, and
/// nothing is sent. Buses between processes are not tried: that would join them.
void probe_buses(const machine::MachineConfig& machine, std::vector<text::Finding>& findings);

}  // namespace servogate::gateway
