// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "machine/config.hpp"
#include "machine/device.hpp"
#include "machine/keys/key.hpp"

/// Which tables of keys exist; each is defined beside its keys.
namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<ArcFeed>();
template <>
std::span<const std::string_view> choices_of<ThreadSide>();
template <>
std::span<const std::string_view> choices_of<ProbeLatch>();
template <>
std::span<const std::string_view> choices_of<AxisType>();
template <>
std::span<const std::string_view> choices_of<MachineKind>();
template <>
std::span<const std::string_view> choices_of<Direction>();
template <>
std::span<const std::string_view> choices_of<HomingMethod>();
template <>
std::span<const std::string_view> choices_of<BoardOutput>();
template <>
std::span<const std::string_view> choices_of<BoardFeedback>();
template <>
std::span<const std::string_view> choices_of<StationKind>();
template <>
std::span<const std::string_view> choices_of<image::Writer>();
template <>
std::span<const std::string_view> choices_of<DeviceKind>();
template <>
std::span<const std::string_view> choices_of<LossReaction>();
template <>
std::span<const std::string_view> choices_of<Coupling>();
template <>
std::span<const std::string_view> choices_of<ThreadMaster>();
template <>
std::span<const std::string_view> choices_of<GearSource>();
template <>
std::span<const std::string_view> choices_of<InverterProtocol>();
template <>
std::span<const std::string_view> choices_of<ConnectionLoss>();
template <>
std::span<const std::string_view> choices_of<FaultResetBy>();
template <>
std::span<const std::string_view> choices_of<PositionMode>();
template <>
std::span<const std::string_view> choices_of<SpeedMode>();
template <>
std::span<const std::string_view> choices_of<PointBias>();

template <>
const Section& section_of<HomingConfig>();
template <>
const Section& section_of<BrakeConfig>();
template <>
const Section& section_of<BoardChannelConfig>();
template <>
const Section& section_of<AxisConfig>();
template <>
const Section& section_of<GearConfig>();
template <>
const Section& section_of<SpindleConfig>();
template <>
const Section& section_of<NodeConfig>();
template <>
const Section& section_of<BusConfig>();
template <>
const Section& section_of<PointConfig>();
template <>
const Section& section_of<LineConfig>();
template <>
const Section& section_of<StationConfig>();
template <>
const Section& section_of<SymbolConfig>();
template <>
const Section& section_of<PlcConfig>();
template <>
const Section& section_of<SafetyConfig>();
template <>
const Section& section_of<ModbusServerConfig>();
template <>
const Section& section_of<PendantConfig>();
template <>
const Section& section_of<PathWheelConfig>();
template <>
const Section& section_of<ElectronicGearConfig>();
template <>
const Section& section_of<PendantMap>();
template <>
const Section& section_of<RunConfig>();
template <>
const Section& section_of<RealtimeConfig>();
template <>
const Section& section_of<ControlConfig>();
template <>
const Section& section_of<SimulatedSwitch>();
template <>
const Section& section_of<SimulatedLoop>();
template <>
const Section& section_of<SimulatedIndexer>();
template <>
const Section& section_of<SimulatedDrive>();
template <>
const Section& section_of<SimulatedAmplifier>();
template <>
const Section& section_of<SimulationConfig>();
/// The whole machine file.
template <>
const Section& section_of<MachineConfig>();

template <>
const Section& section_of<PdoConfig>();
template <>
const Section& section_of<MotorConfig>();
template <>
const Section& section_of<BehaviourConfig>();
template <>
const Section& section_of<DeviceError>();
template <>
const Section& section_of<ModbusMap>();
template <>
const Section& section_of<InverterRequired>();
template <>
const Section& section_of<InverterMap>();
/// The whole device file.
template <>
const Section& section_of<DeviceConfig>();

}  // namespace servogate::machine
