// SPDX-License-Identifier: Apache-2.0
#include "machine/check/boot_objects.hpp"

#include <cmath>

#include "firmware_if/canopen/402/objects.hpp"
#include "machine/check/findings_motion.hpp"

namespace servogate::machine {

namespace {

namespace object = canopen::object;

/// Commands: what the gate to motion gives in each cycle, outputs among it, and what a device does at once
/// (store, restore, program, NMT). A target may stand at 0, for a drive that has it in
/// a PDO and does not follow it.
bool is_command(int index, int subindex, double value) {
  switch (index) {
    case object::kControlword:
    case object::kModesOfOperation:
    case object::kTargetPosition:
    case object::kInterpolationData:
    case object::kStoreParameters:
    case object::kRestoreParameters:
    case object::kProgramData:
    case object::kProgramControl:
    case object::kRequestNmt:
      return true;
    case object::kDigitalOutputs:
      return subindex == 1;
    case object::kVlTargetVelocity:
    case object::kTargetVelocity:
    case object::kTargetTorque:
      return value != 0.0;
    default:
      return false;
  }
}

/// What stands for an object that the boot-up writes (firmware_if/canopen/302/boot_plan.cpp); empty: it does
/// not write it.
std::string owner(int index, const DeviceConfig* device) {
  const auto pdo = [index](int first) { return index >= first && index < first + 4; };
  if (pdo(object::kRpdoParameter) || pdo(object::kRpdoMapping)) return "[[rpdo]]";
  if (pdo(object::kTpdoParameter) || pdo(object::kTpdoMapping)) return "[[tpdo]]";
  if (index == object::kCobIdSync) return "SYNC 080h";
  if (index == object::kProducerHeartbeatTime) return "heartbeat";
  if (device == nullptr || !device->drive()) return {};
  const BehaviourConfig& b = device->behaviour;
  if (index == object::kConsumerHeartbeatTime && b.heartbeat_consumer && b.guard_time <= 0.0)
    return "heartbeat";
  if ((index == object::kGuardTime || index == object::kLifeTimeFactor) && b.guard_time > 0.0)
    return "guard_time, life_time_factor";
  if (index == object::kAbortConnectionOption && b.connection_loss != ConnectionLoss::none)
    return "connection_loss";
  if (index == object::kInterpolationTimePeriod && b.interpolation_period) return "cycle_time";
  if (index == object::kCommunicationCyclePeriod && b.cycle_period) return "cycle_time";
  return {};
}

void check_object(const std::string& name, double value, const DeviceConfig* device, const Where& where,
                  Reading& reading) {
  const auto object = parse_object(name);
  const int bits = object && object->bits != 0 ? object->bits : 32;
  if (!object || (bits != 8 && bits != 16 && bits != 32))
    return reading.error(where, finding::kBadObject, {name, "6065:00/32"});
  if (value != std::nearbyint(value) || value < -std::ldexp(1.0, bits - 1) || value >= std::ldexp(1.0, bits))
    return reading.error(where, finding::kObjectValue, {name, text::number(value), std::to_string(bits)});
  if (is_command(object->index, object->subindex, value))
    return reading.error(where, finding::kObjectCommand, {name});
  if (object->index == object::kQuickStopOption && value == 0.0 && (device == nullptr || device->drive()))
    return reading.error(where, finding::kQuickStopCoasts, {name});
  if (const std::string key = owner(object->index, device); !key.empty())
    reading.error(where, finding::kObjectOwned, {name, key});
}

}  // namespace

void check_boot_objects(const std::map<std::string, double>& objects, const DeviceConfig* device,
                        const std::function<Where(const std::string& name)>& where, Reading& reading) {
  std::map<std::pair<int, int>, std::string> seen;
  for (const auto& [name, value] : objects) {
    check_object(name, value, device, where(name), reading);
    const auto object = parse_object(name);
    if (!object) continue;
    const auto [it, fresh] = seen.try_emplace({object->index, object->subindex}, name);
    if (!fresh) reading.error(where(name), finding::kObjectTwice, {name, it->second});
  }
}

}  // namespace servogate::machine
