// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/simulated/simulated_node.hpp"

#include <cmath>

#include "gateway/compose/axis_setup.hpp"

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
  if (axis != nullptr && axis->brake.present() && axis->brake.drive_output)
    p.brake_torque_nm = p.peak_torque_nm;
  return p;
}

/// What its device file says of a drive, its simulation is like.
canopen::DriveQuirks quirks_of(const machine::DeviceConfig& device) {
  const machine::BehaviourConfig& b = device.behaviour;
  canopen::DriveQuirks q;
  q.halt = b.halt;
  if (b.fault_reset == machine::FaultResetBy::level) q.fault_reset_level_ns = 30'000'000;
  q.homing_method_here = static_cast<std::int8_t>(b.homing_method_here);
  q.homing_method_none = b.homing_method_none;
  q.homing_method_list = b.homing_method_list;
  q.velocity_in_ip_record = b.ip_record == std::vector<std::string>{"position", "velocity"};
  return q;
}

}  // namespace

double units_per_revolution(const machine::AxisConfig& a) {
  const double units = a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
  return a.direction == machine::Direction::plus ? units : -units;
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
  if (device != nullptr) drive.quirks = quirks_of(*device);
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
  return drive;
}

}  // namespace servogate::gateway
