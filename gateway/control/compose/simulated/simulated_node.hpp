// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "drivers/mock/drive/simulated_drive.hpp"
#include "drivers/mock/io/simulated_encoder.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "machine/load.hpp"

/// The drive behind a node of the machine file, as it is simulated: in the control's own process on a mock
/// bus, in a process of its own on others. Not real-time safe.
namespace servogate::gateway {

/// Axis units per turn of the motor, with the sign of the axis' direction.
double units_per_revolution(const machine::AxisConfig& axis);

/// Name plate, motor and load of a node from its device file, its axis or spindle and [[simulation.drive]].
mock::SimulatedDriveConfig simulated_node(const machine::LoadResult& loaded, const machine::BusConfig& bus,
                                          const machine::NodeConfig& node);
/// The module of a device file of CiA 401, with the terminals that its process data have.
mock::SimulatedIoConfig simulated_module(const machine::DeviceConfig& device, int node);
/// The encoder of a device file of CiA 406.
mock::SimulatedEncoderConfig simulated_encoder(const machine::DeviceConfig& device, int node);
/// A drive from a device file alone; nullptr: a drive with the simulation's own defaults.
mock::SimulatedDriveConfig simulated_device(const machine::DeviceConfig* device, int node);

}  // namespace servogate::gateway
