// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "drivers/mock/world/world.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/modbus/line_counters.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/load.hpp"

/// The inputs and outputs of a machine file that do not come over a CAN bus. Not real-time safe.
namespace servogate::gateway {

/// Refuses every url of a [[line]] and of a chip that no row of the device table opens, at its place in the
/// machine file; `check` and compose() call the same. True: all can be tried.
bool check_devices(const machine::LoadResult& loaded, std::vector<text::Finding>& findings);

/// What open_devices() would refuse on this computer: a serial device that is not there, a chip whose line
/// another program holds. Nothing outside is changed.
void probe_devices(const machine::LoadResult& loaded, std::vector<text::Finding>& findings);

/// A device of the machine file in the cycle.
struct OpenDevice {
  std::unique_ptr<image::CycleDevice> device;
  const machine::LineConfig* line = nullptr;      ///< nullptr: it is none
  const modbus::CountedLine* counters = nullptr;  ///< of a line; nullptr: closed, as a record is replayed
};

/// Opens all devices, in the order of the machine file; a line stands where its first station does. What
/// cannot be opened is a finding with device_not_opened(), and the list is then not whole. `replay`: real
/// ones are left closed, what came in comes from the record.
std::vector<OpenDevice> open_devices(const machine::LoadResult& loaded, mock::World& world, bool replay,
                                     std::vector<text::Finding>& findings);
/// True of a finding of open_devices(): the computer is at fault, not the file.
bool device_not_opened(const text::Finding& finding);

}  // namespace servogate::gateway
