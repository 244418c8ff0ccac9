// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/boot_plan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/406/objects.hpp"

namespace servogate::canopen {
namespace {

using Kind = BootAction::Kind;
using Keep = BootAction::Keep;

class Plan {
 public:
  explicit Plan(std::vector<BootAction>& actions) : actions_(actions) {}
  void step(BootStep step) { step_ = step; }
  void nmt(Kind kind) { add({kind, step_}); }
  void write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value,
             bool optional = false) {
    add({Kind::write, step_, index, subindex, bytes, value, 0, optional});
  }
  void check(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value,
             std::uint32_t mask = 0xFFFF'FFFF, bool optional = false) {
    add({Kind::read, step_, index, subindex, bytes, value, mask, optional});
  }
  void write_and_check(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value,
                       bool optional = false) {
    write(index, subindex, bytes, value, optional);
    check(index, subindex, bytes, value, 0xFFFF'FFFF, optional);
  }
  void learn(std::uint16_t index, std::uint8_t subindex, Keep keep, std::optional<std::uint32_t> wanted,
             std::uint32_t mask, bool optional) {
    add({Kind::read, step_, index, subindex, 4, wanted.value_or(0), wanted ? mask : 0, optional && !wanted,
         keep});
  }
  /// Kept where the device has it.
  void note(std::uint16_t index, std::uint8_t bytes, Keep keep) {
    add({Kind::read, step_, index, 0, bytes, 0, 0, true, keep});
  }
  void write_data(std::uint16_t index, std::uint8_t subindex, std::vector<std::uint8_t> data) {
    add({Kind::write, step_, index, subindex}).data = std::move(data);
  }
  void read_text(std::uint16_t index, std::string_view text) {
    add({Kind::read_text, step_, index, 0}).data.assign(text.begin(), text.end());
  }
  void await(Kind kind, std::uint16_t index = 0, std::uint8_t subindex = 0) {
    add({kind, step_, index, subindex, static_cast<std::uint8_t>(index ? 4 : 0)});
  }
  void find(std::uint16_t index, std::int8_t value) {
    add({Kind::find_in_list, step_, index, 0, 1, static_cast<std::uint8_t>(value), 0xFF, true});
  }
  /// A comparison that leaves out what stands between it and land().
  std::size_t jump(Kind kind, std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
    add({kind, step_, index, subindex, 4, value, 0xFFFF'FFFF});
    return actions_.size();
  }
  void land(std::size_t from) {
    actions_[from - 1].jump = static_cast<std::uint16_t>(actions_.size() - from);
  }

 private:
  BootAction& add(BootAction action) { return actions_.emplace_back(std::move(action)); }
  std::vector<BootAction>& actions_;
  BootStep step_ = BootStep::reset;
};

void add_identity(Plan& plan, const DriveProfile& profile) {
  plan.step(BootStep::device_type);
  plan.learn(object::kDeviceType, 0, Keep::device_type, profile.device_type, profile.device_type_mask, false);
  plan.step(BootStep::identity);
  constexpr std::uint32_t kAll = 0xFFFF'FFFF;
  plan.learn(object::kIdentity, 1, Keep::vendor_id, profile.vendor_id, kAll, false);
  plan.learn(object::kIdentity, 2, Keep::product_code, profile.product_code, kAll, true);
  plan.learn(object::kIdentity, 3, Keep::revision, profile.revision, kAll, true);
  plan.learn(object::kIdentity, 4, Keep::serial, std::nullopt, kAll, true);
}

// Stop, clear, write, start, each with the flash at rest after it, and then see what runs. Source: CiA 302-3,
// "Program download".
void add_program(Plan& plan, const NodeProgram& program) {
  plan.step(BootStep::program);
  const std::uint8_t n = program.number;
  if (program.image.empty()) return plan.check(object::kProgramIdentification, n, 4, program.identification);
  constexpr std::uint8_t kStop = 0, kStart = 1, kClear = 3;
  const std::size_t right =
      plan.jump(Kind::jump_if_equal, object::kProgramIdentification, n, program.identification);
  plan.write(object::kProgramControl, n, 1, kStop);
  plan.write(object::kProgramControl, n, 1, kClear);
  plan.await(Kind::await_flash, object::kFlashStatus, n);
  plan.write_data(object::kProgramData, n, program.image);
  plan.await(Kind::await_flash, object::kFlashStatus, n);
  plan.write(object::kProgramControl, n, 1, kStart);
  plan.await(Kind::await_boot_up);
  plan.check(object::kProgramIdentification, n, 4, program.identification);
  plan.land(right);
}

void add_configuration(Plan& plan, const NodeConfig& node) {
  const NodeSetup& setup = node.setup;
  if (setup.concise_dcf.empty()) return;
  const auto entries = parse_concise_dcf(setup.concise_dcf);
  if (!entries) throw std::invalid_argument("the concise DCF of " + node.name + " is cut off");
  plan.step(BootStep::configuration);
  std::size_t days = 0, time = 0;
  if (const auto& date = setup.configuration_date) {
    days = plan.jump(Kind::jump_unless_equal, object::kVerifyConfiguration, 1, date->days);
    time = plan.jump(Kind::jump_if_equal, object::kVerifyConfiguration, 2, date->milliseconds);
    plan.land(days);
  }
  for (const ConfigurationEntry& e : *entries) plan.write_data(e.index, e.subindex, e.data);
  if (const auto& date = setup.configuration_date) {
    plan.write(object::kVerifyConfiguration, 1, 4, date->days);
    plan.write(object::kVerifyConfiguration, 2, 4, date->milliseconds);
  }
  constexpr std::uint32_t kSave = 0x65766173;  // "save", CiA 301, 7.5.2.13
  if (setup.store_configuration) plan.write(object::kStoreParameters, 1, 4, kSave);
  if (setup.configuration_date) plan.land(time);
}

void add_modes(Plan& plan, const DriveProfile& profile) {
  if (profile.check_modes) {
    plan.step(BootStep::supported_modes);
    plan.check(object::kSupportedDriveModes, 0, 4, profile.modes, profile.modes);
  }
}

void add_encoder(Plan& plan, const NodeSetup& setup) {
  plan.step(BootStep::encoder_resolution);
  if (setup.counts_per_rev) plan.check(encoder::kSingleTurnResolution, 0, 4, *setup.counts_per_rev);
  if (setup.revolutions) plan.check(encoder::kRevolutions, 0, 2, *setup.revolutions);
}

void add_guarding(Plan& plan, const NodeConfig& node, const SegmentConfig& segment) {
  const DriveProfile& profile = node.profile;
  if (profile.guard_time_ms > 0) {
    plan.step(BootStep::node_guarding);
    plan.write_and_check(object::kGuardTime, 0, 2, profile.guard_time_ms);
    plan.write_and_check(object::kLifeTimeFactor, 0, 1, profile.life_time_factor);
  } else if (profile.has_heartbeat_consumer) {
    plan.step(BootStep::heartbeat_consumer);
    const auto time = static_cast<std::uint32_t>(segment.heartbeat_timeout_ms) & 0xFFFF;
    plan.write_and_check(object::kConsumerHeartbeatTime, 1, 4,
                         static_cast<std::uint32_t>(segment.own_node) << 16 | time);
  }
  // In an I/O module 6007h is a mask of events.
  if (profile.abort_connection_option && node.target != DriveTarget::io) {
    plan.step(BootStep::abort_connection);
    plan.write_and_check(object::kAbortConnectionOption, 0, 2,
                         static_cast<std::uint16_t>(*profile.abort_connection_option));
  }
}

/// What the outputs of a module do when it has lost its master: in state Pre-operational (1029h:01 = 0) they
/// go to the values of their points, or stay. Source: CiA 301, 7.5.2.31; CiA 401-1, 6206h, 6207h, 6443h,
/// 6444h.
void add_error_states(Plan& plan, const NodeConfig& node) {
  if (node.target != DriveTarget::io) return;
  plan.step(BootStep::error_states);
  plan.write_and_check(object::kErrorBehaviour, 1, 1, 0, true);
  if (!node.io.error_states) return;
  for (const PdoWanted& pdo : node.profile.rpdo)
    for (const MappingEntry& mapped : pdo.mapping.used()) {
      const bool digital = mapped.index == io::kWriteOutput8;
      if (!digital && mapped.index != io::kWriteAnalogueOutput16) continue;
      std::uint32_t mode = digital ? 0xFF : 1, value = 0;  // lines that are no point go to 0
      for (const IoPoint& p : node.io.points) {
        if (p.index != mapped.index || p.subindex != mapped.subindex) continue;
        if (p.rule.hold) mode &= ~(1u << std::max<int>(0, p.bit));
        if (digital && p.rule.loss != 0.0) value |= 1u << p.bit;
        // The 16 bits of a channel stand in the upper half.
        if (!digital) value = static_cast<std::uint32_t>(std::lround(p.rule.loss)) << 16;
      }
      plan.write_and_check(digital ? io::kErrorModeOutput8 : io::kErrorModeAnalogueOutput, mapped.subindex, 1,
                           mode);
      plan.write_and_check(digital ? io::kErrorValueOutput8 : io::kErrorValueAnalogueOutput, mapped.subindex,
                           digital ? 1 : 4, value);
    }
}

void add_sync(Plan& plan, const DriveProfile& profile, const SegmentConfig& segment) {
  plan.step(BootStep::sync);
  plan.write(object::kCobIdSync, 0, 4, cob::kSync, true);
  plan.check(object::kCobIdSync, 0, 4, cob::kSync, 0x1FFF'FFFF, true);
  // 1019h may change only while 1006h is 0 (CiA 301, 7.5.2.22).
  if (segment.sync_counter_overflow > 0) {
    if (profile.has_cycle_period) plan.write(object::kCommunicationCyclePeriod, 0, 4, 0);
    plan.write_and_check(object::kSyncCounterOverflow, 0, 1, segment.sync_counter_overflow);
  }
  if (segment.sync_window_us > 0)
    plan.write_and_check(object::kSynchronousWindowLength, 0, 4,
                         static_cast<std::uint32_t>(segment.sync_window_us));
  if (profile.has_cycle_period)
    plan.write_and_check(object::kCommunicationCyclePeriod, 0, 4,
                         static_cast<std::uint32_t>(segment.cycle_ns / image::kMicrosecond));
}

// Home is at 0 of the drive's own counting, wherever the machine has it.
void add_homing(Plan& plan, const NodeConfig& node) {
  if (!node.setup.homing) return;
  const NodeHoming& homing = *node.setup.homing;
  plan.step(BootStep::homing);
  if (homing.method == 0) {
    if (node.profile.homing_method_none) plan.write_and_check(object::kHomingMethod, 0, 1, 0, true);
    return;
  }
  const std::int8_t number = homing.method == 37 ? node.profile.homing_method_here : homing.method;
  if (node.profile.homing_method_list) plan.find(object::kSupportedHomingMethods, number);
  plan.write_and_check(object::kHomingMethod, 0, 1, static_cast<std::uint8_t>(number));
  plan.write_and_check(object::kHomeOffset, 0, 4, 0);
  if (homing.speed_switch > 0) plan.write_and_check(object::kHomingSpeeds, 1, 4, homing.speed_switch);
  if (homing.speed_zero > 0) plan.write_and_check(object::kHomingSpeeds, 2, 4, homing.speed_zero);
  if (homing.acceleration > 0) plan.write_and_check(object::kHomingAcceleration, 0, 4, homing.acceleration);
}

/// What the device file or the machine file writes itself is theirs.
bool given(const DriveProfile& profile, std::uint16_t index) {
  return std::ranges::any_of(profile.settings, [index](const SdoSetting& s) { return s.index == index; });
}

// The factors are read in any case: with others every speed would be another one. A drive need not have them,
// nor a ramp of its own for the quick stop.
void add_vl(Plan& plan, const NodeConfig& node) {
  if (!node.setup.vl) return;
  const NodeVl& vl = *node.setup.vl;
  for (std::uint8_t i = 0; i < 2; ++i) {
    const auto sub = static_cast<std::uint8_t>(i + 1);
    plan.check(object::kVlSetpointFactor, sub, 2, static_cast<std::uint16_t>(vl.set_point_factor[i]), 0xFFFF,
               true);
    plan.check(object::kVlDimensionFactor, sub, 4, static_cast<std::uint32_t>(vl.dimension_factor[i]),
               0xFFFF'FFFF, true);
  }
  if (!given(node.profile, object::kVlMinMax)) {
    plan.write_and_check(object::kVlMinMax, 1, 4, vl.least, true);
    plan.write_and_check(object::kVlMinMax, 2, 4, vl.most, true);
  }
  if (vl.ramp.speed == 0) return;
  for (const std::uint16_t ramp : {object::kVlAcceleration, object::kVlDeceleration, object::kVlQuickStop}) {
    if (given(node.profile, ramp)) continue;
    plan.write_and_check(ramp, 1, 4, vl.ramp.speed, ramp == object::kVlQuickStop);
    plan.write_and_check(ramp, 2, 2, vl.ramp.seconds, ramp == object::kVlQuickStop);
  }
}

void add_torque(Plan& plan, const NodeConfig& node) {
  if (!node.setup.torque) return;
  const NodeTorque& torque = *node.setup.torque;
  if (torque.slope > 0 && !given(node.profile, object::kTorqueSlope))
    plan.write_and_check(object::kTorqueSlope, 0, 4, torque.slope);
  if (torque.slope > 0 && !given(node.profile, object::kTorqueProfileType))
    plan.write_and_check(object::kTorqueProfileType, 0, 2, 0, true);  // linear
  if (torque.max_speed > 0 && !given(node.profile, object::kMaxMotorSpeed))
    plan.write_and_check(object::kMaxMotorSpeed, 0, 4, torque.max_speed, true);
}

struct PdoPlace {
  std::uint16_t parameter;
  std::uint16_t mapping;
  std::uint32_t id;
  bool transmit;
};

void check_map(Plan& plan, const PdoPlace& place, const PdoWanted& pdo) {
  plan.check(place.mapping, 0, 1, pdo.mapping.count);
  for (std::uint8_t i = 0; i < pdo.mapping.count; ++i)
    plan.check(place.mapping, static_cast<std::uint8_t>(i + 1), 4, pdo.mapping.entries[i].word());
}

void write_map(Plan& plan, const PdoPlace& place, const PdoWanted& pdo) {
  plan.write(place.mapping, 0, 1, 0);
  for (std::uint8_t i = 0; i < pdo.mapping.count; ++i)
    plan.write(place.mapping, static_cast<std::uint8_t>(i + 1), 4, pdo.mapping.entries[i].word());
  plan.write(place.mapping, 0, 1, pdo.mapping.count);
}

void add_pdo(Plan& plan, const PdoPlace& place, const PdoWanted& pdo, bool fixed) {
  const std::uint32_t flags = place.transmit && !pdo.remote() ? cob::kNoRemote : 0;
  const std::uint32_t off = cob::kInvalid | flags | place.id;
  constexpr std::uint32_t kIdAndValid = cob::kInvalid | 0x1FFF'FFFF;
  if (!pdo.used()) {
    // A device may have fewer PDOs than we know of.
    plan.write(place.parameter, 1, 4, off, true);
    return;
  }
  plan.write(place.parameter, 1, 4, off);
  if (!fixed) write_map(plan, place, pdo);
  plan.write_and_check(place.parameter, 2, 1, pdo.transmission_type);
  if (pdo.inhibit_100us && place.transmit) plan.write_and_check(place.parameter, 3, 2, pdo.inhibit_100us);
  if (pdo.event_ms && !pdo.remote()) plan.write_and_check(place.parameter, 5, 2, pdo.event_ms);
  plan.write(place.parameter, 1, 4, flags | place.id);
  check_map(plan, place, pdo);
  plan.check(place.parameter, 1, 4, place.id, kIdAndValid);
}

void add_pdos(Plan& plan, const NodeConfig& node) {
  for (int transmit = 0; transmit < 2; ++transmit) {
    plan.step(transmit ? BootStep::tpdo : BootStep::rpdo);
    for (std::uint16_t n = 0; n < 4; ++n) {
      const auto parameter = transmit ? object::kTpdoParameter : object::kRpdoParameter;
      const auto mapping = transmit ? object::kTpdoMapping : object::kRpdoMapping;
      const PdoPlace place{static_cast<std::uint16_t>(parameter + n), static_cast<std::uint16_t>(mapping + n),
                           transmit ? cob::tpdo(n + 1, node.node) : cob::rpdo(n + 1, node.node),
                           transmit != 0};
      add_pdo(plan, place, transmit ? node.profile.tpdo[n] : node.profile.rpdo[n],
              node.profile.pdo_map_fixed);
    }
  }
}

void add_mode(Plan& plan, const NodeConfig& node, const SegmentConfig& segment) {
  const DriveProfile& profile = node.profile;
  if (profile.interpolation_base) {
    plan.step(BootStep::interpolation_time);
    std::uint8_t value = 0;
    std::int8_t exponent = 0;
    if (!interpolation_time(segment.cycle_ns, *profile.interpolation_base, value, exponent))
      throw std::invalid_argument("cycle time cannot be written into 60C2h");
    plan.write_and_check(object::kInterpolationTimePeriod, 2, 1, static_cast<std::uint8_t>(exponent));
    plan.write_and_check(object::kInterpolationTimePeriod, 1, 1, value);
  }
  // Nothing of an earlier run may be interpolated; sub-index 6 can only be written.
  if (profile.ip_buffer) {
    plan.step(BootStep::interpolation_time);
    plan.write(object::kInterpolationBuffer, kBufferClear, 1, 0);
  }
  plan.step(BootStep::mode);
  const OperationMode mode = node.target == DriveTarget::axis ? profile.position_mode : profile.velocity_mode;
  plan.write(object::kModesOfOperation, 0, 1, static_cast<std::uint8_t>(mode));
}

}  // namespace

bool interpolation_time(image::Nanoseconds cycle_ns, std::int8_t base, std::uint8_t& value,
                        std::int8_t& exponent) {
  for (exponent = base; exponent >= -9; --exponent) {
    image::Nanoseconds unit = 1;
    for (int i = -9; i < exponent; ++i) unit *= 10;
    if (cycle_ns < unit || cycle_ns % unit != 0) continue;
    if (cycle_ns / unit > 255) return false;
    value = static_cast<std::uint8_t>(cycle_ns / unit);
    return true;
  }
  return false;
}

std::vector<BootAction> boot_plan(const NodeConfig& node, const SegmentConfig& segment) {
  std::vector<BootAction> actions;
  Plan plan(actions);
  plan.nmt(Kind::reset);
  add_identity(plan, node.profile);
  if (node.setup.program) add_program(plan, *node.setup.program);
  if (!node.setup.software_version.empty()) {
    plan.step(BootStep::software_version);
    plan.read_text(object::kSoftwareVersion, node.setup.software_version);
  }
  if (node.target != DriveTarget::io) add_modes(plan, node.profile);
  add_encoder(plan, node.setup);
  add_configuration(plan, node);
  plan.step(BootStep::settings);
  if (node.setup.quick_stop_ramp > 0 && node.setup.concise_dcf.empty())
    plan.write_and_check(object::kQuickStopDeceleration, 0, 4, node.setup.quick_stop_ramp, true);
  // The brake must be engaged before anything, a mask in the settings for one, can hand it to the output.
  if (node.profile.brake_bit >= 0)
    plan.write_and_check(object::kDigitalOutputs, 1, 4,
                         node.profile.brake_bit_releases ? 0 : 1u << node.profile.brake_bit);
  for (const SdoSetting& setting : node.profile.settings) {
    plan.write(setting.index, setting.subindex, setting.bytes, setting.value);
    if (setting.read_back) plan.check(setting.index, setting.subindex, setting.bytes, setting.value);
  }
  if (node.setup.profile_speed > 0)
    plan.write_and_check(object::kProfileVelocity, 0, 4, node.setup.profile_speed);
  if (node.setup.speed_ramp > 0)
    for (const std::uint16_t ramp : {object::kProfileAcceleration, object::kProfileDeceleration})
      plan.write_and_check(ramp, 0, 4, node.setup.speed_ramp);
  add_vl(plan, node);
  add_torque(plan, node);
  add_homing(plan, node);
  add_guarding(plan, node, segment);
  add_error_states(plan, node);
  add_sync(plan, node.profile, segment);
  add_pdos(plan, node);
  if (node.target != DriveTarget::io) add_mode(plan, node, segment);
  plan.step(BootStep::heartbeat_producer);
  if (node.profile.guard_time_ms > 0)  // a heartbeat producer would not answer guarding
    plan.write(object::kProducerHeartbeatTime, 0, 2, 0, true);
  else
    plan.write_and_check(object::kProducerHeartbeatTime, 0, 2,
                         static_cast<std::uint16_t>(heartbeat_ms(node, segment)));
  plan.step(BootStep::start);
  // What put it into its fault before this control was there.
  if (node.target != DriveTarget::io) plan.note(object::kErrorCode, 2, Keep::error_code);
  if (segment.sync_counter_overflow > 0) plan.await(Kind::await_sync);
  plan.nmt(Kind::start);
  return actions;
}

}  // namespace servogate::canopen
