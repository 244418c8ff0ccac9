// SPDX-License-Identifier: Apache-2.0
// What the CANopen master knows of a device, from its file and its node.
#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/406/objects.hpp"
#include "machine/device.hpp"
#include "machine/loading/mode_names.hpp"

namespace servogate::machine {

namespace {

void put_pdos(const std::vector<PdoConfig>& from, std::array<canopen::PdoWanted, 4>& to) {
  for (const PdoConfig& pdo : from) {
    if (pdo.number < 1 || pdo.number > 4) continue;
    canopen::PdoWanted& wanted = to[static_cast<std::size_t>(pdo.number - 1)];
    wanted.transmission_type = static_cast<std::uint8_t>(pdo.transmission);
    wanted.inhibit_100us = static_cast<std::uint16_t>(std::lround(pdo.inhibit * 1e4));
    wanted.event_ms = static_cast<std::uint16_t>(std::lround(pdo.event * 1e3));
    for (const PdoObject& o : pdo.objects) wanted.mapping.add({o.index, o.subindex, o.bits});
  }
}

void put_settings(const std::map<std::string, double>& from, const std::vector<std::string>& write_only,
                  std::vector<canopen::SdoSetting>& to) {
  for (const auto& [text, value] : from) {
    const auto object = parse_object(text);
    if (!object) continue;
    canopen::SdoSetting setting;
    setting.index = object->index;
    setting.subindex = object->subindex;
    setting.bytes = static_cast<std::uint8_t>(object->bits == 0 ? 4 : object->bits / 8);
    setting.value = static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
    setting.read_back = std::none_of(write_only.begin(), write_only.end(), [&](const std::string& name) {
      const auto other = parse_object(name);
      return other && other->index == object->index && other->subindex == object->subindex;
    });
    to.push_back(setting);
  }
}

std::optional<std::uint32_t> given(std::int64_t value) {
  if (value == 0) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

void put_behaviour(const BehaviourConfig& b, canopen::DriveProfile& p) {
  p.torque_unit_permille = b.torque_unit;
  p.acceleration_unit_counts_s2 = b.acceleration_unit;
  p.halt = b.halt;
  p.homing_method_here = static_cast<std::int8_t>(b.homing_method_here);
  p.homing_method_none = b.homing_method_none;
  p.homing_method_list = b.homing_method_list;
  p.velocity_unit_counts_s =
      b.velocity_in_rpm ? static_cast<double>(p.counts_per_rev) / 60.0 : b.velocity_unit;
  p.modes = 0;
  for (const std::string& m : b.modes) p.modes |= canopen::supported_bit(mode_of(m));
  p.check_modes = b.check_modes;
  static constexpr std::string_view kPosition[] = {"csp", "ip", "pp"};
  p.position_mode = mode_of(kPosition[static_cast<std::size_t>(b.position_mode)]);
  p.ip_buffer = b.ip_buffer && b.position_mode == PositionMode::ip;
  const auto entry = [&b](std::string_view what) {
    const auto found = std::find(b.ip_record.begin(), b.ip_record.end(), what);
    return static_cast<std::uint8_t>(found == b.ip_record.end() ? 0 : found - b.ip_record.begin() + 1);
  };
  p.ip_position_entry = entry("position");
  p.ip_velocity_entry = entry("velocity");
  static constexpr std::string_view kSpeed[] = {"csv", "pv", "vl"};
  p.velocity_mode = mode_of(kSpeed[static_cast<std::size_t>(b.speed_mode)]);
  static constexpr std::string_view kTorque[] = {"cst", "tq"};
  p.torque_mode = mode_of(kTorque[static_cast<std::size_t>(b.torque_mode)]);
  p.fault_reset =
      b.fault_reset == FaultResetBy::level ? canopen::FaultReset::level : canopen::FaultReset::edge;
  p.fault_reset_hold_ms = static_cast<std::int32_t>(std::lround(b.fault_reset_hold * 1e3));
  p.transition_timeout_ms = static_cast<std::int32_t>(std::lround(b.transition_timeout * 1e3));
  p.handover_counts = b.handover_counts;
  p.brake_bit = static_cast<std::int8_t>(b.brake_bit);
  p.brake_bit_releases = b.brake_bit_releases;
  p.pdo_map_fixed = b.fixed_pdo_map;
  p.sdo_only = b.sdo_only;
  p.interpolation_base = b.interpolation_period
                             ? std::optional<std::int8_t>(static_cast<std::int8_t>(b.interpolation_base))
                             : std::nullopt;
  p.command_delay_cycles = static_cast<std::uint8_t>(b.command_delay);
  p.has_cycle_period = b.cycle_period;
  p.has_heartbeat_consumer = b.heartbeat_consumer;
  p.guard_time_ms = static_cast<std::uint16_t>(std::lround(b.guard_time * 1e3));
  p.life_time_factor = static_cast<std::uint8_t>(b.life_time_factor);
  p.abort_connection_option = b.connection_loss == ConnectionLoss::none
                                  ? std::nullopt
                                  : std::optional<std::int16_t>(static_cast<std::int16_t>(b.connection_loss));
}

}  // namespace

VlFactor vl_factor(const canopen::DriveProfile& profile, std::uint16_t index) {
  VlFactor factor;
  for (const canopen::SdoSetting& s : profile.settings) {  // a node's own come later
    if (s.index != index || s.value == 0) continue;
    const auto value = s.bytes == 2 ? static_cast<std::int16_t>(s.value) : static_cast<std::int32_t>(s.value);
    if (s.subindex == 1) factor.numerator = value;
    if (s.subindex == 2) factor.denominator = value;
  }
  return factor;
}

canopen::DriveProfile drive_profile(const DeviceConfig& device, const NodeConfig& node,
                                    std::int64_t counts_per_rev) {
  canopen::DriveProfile p;
  p.name = node.device;
  p.manufacturer = device.manufacturer;
  p.description = device.description;
  p.vendor_id = given(device.vendor_id);
  p.product_code = given(device.product_code);
  p.revision = given(device.revision);
  p.counts_per_rev = counts_per_rev > 0 ? counts_per_rev : device.motor.counts_per_rev;
  put_behaviour(device.behaviour, p);
  if (device.kind == DeviceKind::canopen_io) p.device_type = canopen::io::kDeviceProfile;
  if (device.kind == DeviceKind::canopen_encoder) p.device_type = canopen::encoder::kDeviceProfile;
  if (device.terminals()) p.abort_connection_option.reset();  // 6007h is something else there
  put_pdos(device.rpdos, p.rpdo);
  put_pdos(device.tpdos, p.tpdo);
  put_settings(device.objects, device.write_only, p.settings);
  put_settings(node.objects, device.write_only, p.settings);
  double rpm = 1.0;
  for (const VlFactor factor :
       {vl_factor(p, canopen::object::kVlSetpointFactor), vl_factor(p, canopen::object::kVlDimensionFactor)})
    rpm *= static_cast<double>(factor.numerator) / factor.denominator;
  p.vl_unit_counts_s = rpm * static_cast<double>(p.counts_per_rev) / 60.0;
  for (const DeviceError& e : device.errors)
    p.error_texts.push_back({static_cast<std::uint16_t>(e.code), e.english, e.russian});
  return p;
}

}  // namespace servogate::machine
