// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/simulated_node.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/device/io/io_profile.hpp"
#include "gateway/control/compose/setup/axis_setup.hpp"
#include "machine/can_channel.hpp"

namespace servogate::gateway {

namespace {

std::int64_t positive_modulo(std::int64_t value, std::int64_t modulus) {
  const std::int64_t rest = value % modulus;
  return rest < 0 ? rest + modulus : rest;
}

mock::PlantConfig plant_of(const machine::DeviceConfig* device, const machine::SimulatedDrive* extra,
                           const machine::AxisConfig* axis, const machine::SpindleConfig* spindle) {
  mock::PlantConfig p;
  if (device != nullptr) {
    const machine::MotorConfig& m = device->motor;
    if (m.counts_per_rev > 0) p.counts_per_rev = m.counts_per_rev;
    if (m.inertia > 0.0) p.inertia_kg_m2 = m.inertia;
    if (m.rated_torque > 0.0) p.rated_torque_nm = m.rated_torque;
    if (m.peak_torque > 0.0) p.peak_torque_nm = m.peak_torque;
    if (m.max_speed > 0.0) p.max_speed_rad_s = 1.2 * m.max_speed * 2.0 * M_PI / 60.0;
  }
  if (axis != nullptr && axis->counts_per_rev > 0) p.counts_per_rev = axis->counts_per_rev;
  if (spindle != nullptr && spindle->counts_per_rev > 0) p.counts_per_rev = counts_per_motor_turn(*spindle);
  if (extra != nullptr) {
    if (extra->inertia > 0.0) p.inertia_kg_m2 = extra->inertia;
    if (extra->friction_coulomb > 0.0) p.coulomb_friction_nm = extra->friction_coulomb;
    if (extra->friction_viscous > 0.0) p.viscous_friction_nm_s = extra->friction_viscous;
    if (extra->max_torque > 0.0) p.peak_torque_nm = extra->max_torque;
    p.dip_torque_nm = extra->dip_torque;
    p.dip_period_s = extra->dip_period;
    p.dip_time_s = extra->dip_time;
    p.encoder_noise_counts = extra->encoder_noise;
    if (axis != nullptr) {
      const double direction = axis->direction == machine::Direction::plus ? 1.0 : -1.0;
      p.load_torque_nm = extra->gravity_torque * direction;
      const double units = units_per_revolution(*axis);
      p.start_rev = extra->start / units;
      if (std::isfinite(extra->end_stop_min))
        (units > 0.0 ? p.end_stop_min_rev : p.end_stop_max_rev) = extra->end_stop_min / units;
      if (std::isfinite(extra->end_stop_max))
        (units > 0.0 ? p.end_stop_max_rev : p.end_stop_min_rev) = extra->end_stop_max / units;
      p.zero_mark_counts = positive_modulo(std::llround(extra->zero_mark * direction), p.counts_per_rev);
    }
  }
  if (axis != nullptr && axis->brake.present() && axis->brake.drive_output) {
    p.brake_torque_nm = p.peak_torque_nm;
    p.brake_release_s = axis->brake.release_delay;
    p.brake_engage_s = axis->brake.engage_delay;
  }
  return p;
}

/// What its device file says of a drive, its simulation is like.
canopen::DriveQuirks quirks_of(const machine::DeviceConfig& device) {
  const machine::BehaviourConfig& b = device.behaviour;
  canopen::DriveQuirks q;
  q.halt = b.halt;
  q.brake_interlock = b.brake_interlock;
  if (b.fault_reset == machine::FaultResetBy::level) q.fault_reset_level_ns = 30'000'000;
  q.homing_method_here = static_cast<std::int8_t>(b.homing_method_here);
  q.homing_method_none = b.homing_method_none;
  q.homing_method_list = b.homing_method_list;
  q.velocity_in_ip_record = b.ip_record == std::vector<std::string>{"position", "velocity"};
  return q;
}

/// Its process data as its file has them: the maps of a drive that lets nobody write them.
void put_maps(const machine::DeviceConfig& device, mock::SimulatedDriveConfig& drive) {
  if (device.behaviour.fixed_pdo_map) drive.map_access = canopen::MapAccess::fixed;
  for (const bool transmit : {false, true})
    for (const machine::PdoConfig& pdo : transmit ? device.tpdos : device.rpdos) {
      mock::SimulatedDriveConfig::PdoMap map{transmit, pdo.number, {}};
      for (const machine::PdoObject& o : pdo.objects) map.mapping.add({o.index, o.subindex, o.bits});
      drive.maps.push_back(map);
    }
}

/// The probe on an input of the drive, where its axis takes it to the part.
void put_probe(const machine::MachineConfig& m, const machine::AxisConfig& axis,
               mock::SimulatedDriveConfig& drive) {
  if (m.control.probe_latch == machine::ProbeLatch::edge) return;
  const double counts = static_cast<double>(drive.plant.counts_per_rev) / units_per_revolution(axis);
  for (const machine::SimulatedSwitch& s : m.simulation.switches) {
    if (s.point != m.control.probe || s.axis != axis.letter) continue;
    mock::DriveSwitch input;
    input.input = m.control.probe_latch == machine::ProbeLatch::drive_1 ? mock::DriveSwitch::Input::probe_1
                                                                        : mock::DriveSwitch::Input::probe_2;
    const bool falls = counts < 0.0;
    const double from = falls ? s.to : s.from, to = falls ? s.from : s.to;
    if (std::isfinite(from)) input.from = static_cast<std::int64_t>(std::ceil(from * counts));
    if (std::isfinite(to)) input.to = static_cast<std::int64_t>(std::floor(to * counts));
    drive.switches.push_back(input);
  }
}

template <class Config>
void put_name_plate(const machine::DeviceConfig& device, int node, Config& config) {
  config.node_id = static_cast<canopen::NodeId>(node);
  config.serial_number = static_cast<std::uint32_t>(node);
  if (device.vendor_id != 0) config.vendor_id = static_cast<std::uint32_t>(device.vendor_id);
  if (device.product_code != 0) config.product_code = static_cast<std::uint32_t>(device.product_code);
  if (device.revision != 0) config.revision = static_cast<std::uint32_t>(device.revision);
}

}  // namespace

double units_per_revolution(const machine::AxisConfig& a) {
  const double units = a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
  return a.direction == machine::Direction::plus ? units : -units;
}

mock::SimulatedIoConfig simulated_module(const machine::DeviceConfig& device, int node) {
  namespace io = canopen::io;
  mock::SimulatedIoConfig module;
  put_name_plate(device, node, module);
  module.error_states = device.behaviour.connection_loss != machine::ConnectionLoss::none;
  const auto count = [](const std::vector<machine::PdoConfig>& pdos, std::uint16_t index, int each,
                        int most) {
    return static_cast<std::uint8_t>(std::min(each * machine::mapped_subindices(pdos, index), most));
  };
  constexpr int kLines = 8 * static_cast<int>(canopen::IoProfile::kGroups);
  constexpr int kChannels = static_cast<int>(canopen::IoProfile::kChannels);
  module.terminals = {count(device.tpdos, io::kReadInput8, 8, kLines),
                      count(device.rpdos, io::kWriteOutput8, 8, kLines),
                      count(device.tpdos, io::kReadAnalogueInput16, 1, kChannels),
                      count(device.rpdos, io::kWriteAnalogueOutput16, 1, kChannels)};
  return module;
}

mock::SimulatedEncoderConfig simulated_encoder(const machine::DeviceConfig& device, int node) {
  mock::SimulatedEncoderConfig encoder;
  put_name_plate(device, node, encoder);
  if (device.encoder.counts_per_rev > 0)
    encoder.resolution.counts_per_rev = static_cast<std::uint32_t>(device.encoder.counts_per_rev);
  if (device.encoder.revolutions > 0)
    encoder.resolution.revolutions = static_cast<std::uint16_t>(device.encoder.revolutions);
  return encoder;
}

mock::SimulatedDriveConfig simulated_device(const machine::DeviceConfig* device, int node) {
  mock::SimulatedDriveConfig drive;
  drive.node_id = static_cast<canopen::NodeId>(node);
  drive.serial_number = static_cast<std::uint32_t>(node);
  if (device != nullptr && device->vendor_id != 0)
    drive.vendor_id = static_cast<std::uint32_t>(device->vendor_id);
  if (device != nullptr && device->product_code != 0)
    drive.product_code = static_cast<std::uint32_t>(device->product_code);
  drive.plant = plant_of(device, nullptr, nullptr, nullptr);
  if (device != nullptr) {
    drive.quirks = quirks_of(*device);
    put_maps(*device, drive);
  }
  return drive;
}

mock::SimulatedDriveConfig simulated_node(const machine::LoadResult& loaded, const machine::BusConfig& bus,
                                          const machine::NodeConfig& node) {
  const machine::MachineConfig& m = loaded.machine;
  const std::string reference = bus.name + "." + node.name;
  const machine::AxisConfig* axis = nullptr;
  const machine::SpindleConfig* spindle = nullptr;
  const machine::SimulatedDrive* extra = nullptr;
  for (const machine::AxisConfig& a : m.axes)
    if (a.drive == reference) axis = &a;
  for (const machine::SpindleConfig& s : m.spindles)
    if (s.drive == reference) spindle = &s;
  for (const machine::SimulatedDrive& s : m.simulation.drives)
    if (s.node == reference) extra = &s;
  const machine::DeviceConfig* device = loaded.device(node.device);
  mock::SimulatedDriveConfig drive = simulated_device(device, node.id);
  if (!node.program.empty() || node.program_version >= 0) drive.program_memory = std::size_t{1} << 20;
  if (extra != nullptr) drive.absolute_encoder = extra->absolute_encoder;
  drive.plant = plant_of(device, extra, axis, spindle);
  if (axis != nullptr) put_probe(m, *axis, drive);
  return drive;
}

}  // namespace servogate::gateway
