// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/drive_kind.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::gateway {
namespace {

using canopen::OperationMode;
using canopen::supported_bit;
namespace object = canopen::object;

constexpr double rad_s(double rpm) { return rpm * 2.0 * std::numbers::pi / 60.0; }

/// A closed-loop stepper: many poles, much cogging, little speed, no torque beyond its rated one.
void make_stepper(mock::SimulatedDriveConfig& c) {
  c.name = "Servogate simulated stepper drive";
  c.device_type = 0x0004'0192;
  c.product_code = 0x0004'0192;
  c.modes = supported_bit(OperationMode::profile_position) | supported_bit(OperationMode::profile_velocity) |
            supported_bit(OperationMode::homing) | supported_bit(OperationMode::interpolated_position) |
            supported_bit(OperationMode::cyclic_sync_position) |
            supported_bit(OperationMode::cyclic_sync_velocity);
  c.plant.counts_per_rev = 51'200;
  c.plant.inertia_kg_m2 = 3.0e-4;
  c.plant.coulomb_friction_nm = 0.04;
  c.plant.viscous_friction_nm_s = 1.0e-3;
  c.plant.rated_torque_nm = 2.0;
  c.plant.peak_torque_nm = 2.0;
  c.plant.max_speed_rad_s = rad_s(1'800.0);
  c.plant.cogging_nm = 0.05;
  c.plant.cogging_periods = 200.0;
}

/// A spindle motor at a frequency converter: fast, heavy, hot after a while of overload.
void make_spindle(mock::SimulatedDriveConfig& c) {
  c.name = "Servogate simulated spindle drive";
  c.device_type = 0x0001'0192;
  c.product_code = 0x0001'0192 + 0x0010'0000;
  c.modes = supported_bit(OperationMode::velocity) | supported_bit(OperationMode::profile_velocity) |
            supported_bit(OperationMode::profile_torque) | supported_bit(OperationMode::homing) |
            supported_bit(OperationMode::cyclic_sync_position) |
            supported_bit(OperationMode::cyclic_sync_velocity) |
            supported_bit(OperationMode::cyclic_sync_torque);
  c.plant.counts_per_rev = 4'096;
  c.plant.inertia_kg_m2 = 8.0e-3;
  c.plant.coulomb_friction_nm = 0.3;
  c.plant.viscous_friction_nm_s = 2.0e-3;
  c.plant.rated_torque_nm = 14.0;
  c.plant.peak_torque_nm = 28.0;
  c.plant.max_speed_rad_s = rad_s(9'000.0);
  c.plant.thermal_time_s = 60.0;
}

struct Kind {
  std::string_view name;
  void (*make)(mock::SimulatedDriveConfig& c);
};
constexpr Kind kKinds[] = {
    {"servo", [](mock::SimulatedDriveConfig&) {}}, {"stepper", &make_stepper}, {"spindle", &make_spindle}};

mock::SimulatedDriveConfig plain(int node) {
  mock::SimulatedDriveConfig c;
  c.node_id = static_cast<canopen::NodeId>(node);
  c.serial_number = static_cast<std::uint32_t>(node);
  return c;
}

using Plant = mock::PlantConfig;
constexpr PlantKey kKeys[] = {
    {"inertia", 1e-8, 1e4, "kg m2", "rotor, and load where it is rigid",
     [](Plant& p, double v) { p.inertia_kg_m2 = v; }},
    {"load-inertia", 0.0, 1e4, "kg m2", "load at the motor shaft; behind a spring with `stiffness`",
     [](Plant& p, double v) { p.load_inertia_kg_m2 = v; }},
    {"stiffness", 0.0, 1e7, "N m/rad", "compliance between motor and load; 0: rigid",
     [](Plant& p, double v) { p.stiffness_nm_rad = v; }},
    {"damping", 0.0, 1e4, "N m s/rad", "in the coupling", [](Plant& p, double v) { p.damping_nm_s = v; }},
    {"friction", 0.0, 1e4, "N m", "dry friction", [](Plant& p, double v) { p.coulomb_friction_nm = v; }},
    {"viscous", 0.0, 1e3, "N m s/rad", "viscous friction",
     [](Plant& p, double v) { p.viscous_friction_nm_s = v; }},
    {"stribeck", 0.0, 1e4, "N m", "what dry friction has more at rest",
     [](Plant& p, double v) { p.stribeck_friction_nm = v; }},
    {"stribeck-speed", 1e-6, 1e6, "rad/s", "of the motor, where that has fallen to 37 %",
     [](Plant& p, double v) { p.stribeck_speed_rad_s = v; }},
    {"backlash", 0.0, 10.0, "rad", "play between motor and load; with `load-inertia` and `stiffness`",
     [](Plant& p, double v) { p.backlash_rad = v; }},
    {"torque-noise", 0.0, 1e4, "N m", "standard deviation of the measured torque",
     [](Plant& p, double v) { p.torque_noise_nm = v; }},
    {"gravity", -1e4, 1e4, "N m", "constant load, positive pulls towards minus",
     [](Plant& p, double v) { p.load_torque_nm = v; }},
    {"dip-torque", 0.0, 1e4, "N m", "load against the motion that comes and goes",
     [](Plant& p, double v) { p.dip_torque_nm = v; }},
    {"dip-period", 0.01, 1e4, "s", "from one such load to the next",
     [](Plant& p, double v) { p.dip_period_s = v; }},
    {"dip-time", 0.0, 1e4, "s", "that each lasts", [](Plant& p, double v) { p.dip_time_s = v; }},
    {"encoder-noise", 0.0, 1e6, "counts", "that a reading is off at most",
     [](Plant& p, double v) { p.encoder_noise_counts = v; }},
    {"cogging", 0.0, 1e3, "N m", "amplitude of the cogging torque",
     [](Plant& p, double v) { p.cogging_nm = v; }},
    {"cogging-periods", 1.0, 1e4, "", "of it in a revolution",
     [](Plant& p, double v) { p.cogging_periods = v; }},
    {"counts", 4.0, 1e9, "", "encoder counts of a revolution",
     [](Plant& p, double v) { p.counts_per_rev = std::llround(v); }},
    {"torque", 1e-6, 1e5, "N m", "rated torque, 1000 permille of 6071h",
     [](Plant& p, double v) { p.rated_torque_nm = v; }},
    {"peak-torque", 1e-6, 1e5, "N m", "torque limit of the power stage",
     [](Plant& p, double v) { p.peak_torque_nm = v; }},
    {"max-speed", 1.0, 1e6, "rpm", "no torque beyond it",
     [](Plant& p, double v) { p.max_speed_rad_s = rad_s(v); }},
    {"thermal-time", 0.0, 1e5, "s", "I2t: time constant of the motor; 0: it never gets too hot",
     [](Plant& p, double v) { p.thermal_time_s = v; }},
    {"brake", 0.0, 1e5, "N m", "torque of a holding brake; 0: none",
     [](Plant& p, double v) { p.brake_torque_nm = v; }},
    {"zero-mark", 0.0, 1e9, "counts", "place of the zero mark in a revolution",
     [](Plant& p, double v) { p.zero_mark_counts = std::llround(v); }},
    {"start", -1e6, 1e6, "rev", "where the shaft stands at power-on",
     [](Plant& p, double v) { p.start_rev = v; }},
    {"end-stop-min", -1e12, 1e12, "rev", "rigid stop", [](Plant& p, double v) { p.end_stop_min_rev = v; }},
    {"end-stop-max", -1e12, 1e12, "rev", "rigid stop", [](Plant& p, double v) { p.end_stop_max_rev = v; }},
    {"position-gain", 0.0, 1e5, "1/s", "of the position loop",
     [](Plant& p, double v) { p.position_gain = v; }},
    {"velocity-gain", 0.0, 1e5, "N m s/rad", "of the velocity loop; 0: from the inertia",
     [](Plant& p, double v) { p.velocity_gain = v; }},
};

/// A number of a data sheet above zero.
double number_of(const canopen::Eds& sheet, std::uint16_t index, std::uint8_t subindex) {
  const canopen::EdsEntry* entry = sheet.find(index, subindex);
  if (entry == nullptr || entry->value() == nullptr || !entry->value()->number) return 0.0;
  return static_cast<double>(entry->value()->number->value);
}

}  // namespace

std::optional<mock::SimulatedDriveConfig> drive_kind(std::string_view name, int node) {
  for (const Kind& kind : kKinds) {
    if (kind.name != name) continue;
    mock::SimulatedDriveConfig c = plain(node);
    kind.make(c);
    return c;
  }
  return std::nullopt;
}

std::string drive_kinds() {
  std::string names;
  for (const Kind& kind : kKinds) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

mock::SimulatedDriveConfig drive_of_sheet(std::shared_ptr<const canopen::Eds> sheet, int node) {
  mock::SimulatedDriveConfig c = plain(node);
  const double counts = number_of(*sheet, object::kPositionEncoderResolution, 1);
  const double turns = std::max(1.0, number_of(*sheet, object::kPositionEncoderResolution, 2));
  if (counts >= 4.0) c.plant.counts_per_rev = std::llround(counts / turns);
  if (const double mnm = number_of(*sheet, 0x6076, 0); mnm > 0.0) {
    c.plant.peak_torque_nm *= mnm / 1000.0 / c.plant.rated_torque_nm;
    c.plant.rated_torque_nm = mnm / 1000.0;
  }
  if (const double rpm = number_of(*sheet, object::kMaxMotorSpeed, 0); rpm > 0.0)
    c.plant.max_speed_rad_s = rad_s(1.2 * rpm);
  c.data_sheet = std::move(sheet);
  return c;
}

const PlantKey* plant_key(std::string_view key) {
  const auto found =
      std::find_if(std::begin(kKeys), std::end(kKeys), [&](const PlantKey& k) { return k.key == key; });
  return found == std::end(kKeys) ? nullptr : found;
}

std::string plant_keys() {
  std::string names;
  for (const PlantKey& k : kKeys) names += (names.empty() ? "" : ", ") + std::string(k.key);
  return names;
}

}  // namespace servogate::gateway
