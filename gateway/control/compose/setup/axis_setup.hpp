// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/axis/config/axis_config.hpp"
#include "kernel/channel/process.hpp"
#include "machine/load.hpp"

/// The machine file's axes and spindles in the terms of the kernel. Not real-time safe.
namespace servogate::gateway {

/// What the machine does when a node is lost, as the kernel has it.
image::Reaction loss_reaction(machine::LossReaction reaction);

axis::AxisConfig axis_config(const machine::LoadResult& loaded, const machine::AxisConfig& axis);
/// Drive counts of a turn of a spindle on an inverter, which has none of its own.
inline constexpr std::int64_t kInverterCounts = 1'000'000;
axis::SpindleConfig spindle_config(const machine::LoadResult& loaded, const machine::SpindleConfig& spindle);
/// Counts of a spindle's encoder in one turn of its motor, to the nearest; 0: no encoder. What a drive calls
/// a revolution is one of its motor.
std::int64_t counts_per_motor_turn(const machine::SpindleConfig& spindle);
axis::ElectronicGearConfig gear_config(const machine::MachineConfig& machine,
                                       const machine::ElectronicGearConfig& gear);
/// Process `index` (from 0) with the axes that programs move as its path axes, those of other processes too:
/// they rest on its path.
channel::ProcessConfig process_config(const machine::MachineConfig& machine, int index);

}  // namespace servogate::gateway
