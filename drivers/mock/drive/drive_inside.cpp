// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/drive_inside.hpp"

#include <algorithm>
#include <span>

namespace servogate::mock {
namespace {

constexpr std::string_view kNames[kFaultKinds] = {"silent",
                                                  "deaf",
                                                  "heartbeat_lost",
                                                  "pdo_dropped",
                                                  "pdo_late",
                                                  "pdo_corrupted",
                                                  "pdo_repeated",
                                                  "rpdo_dropped",
                                                  "rpdo_late",
                                                  "rpdo_corrupted",
                                                  "sdo_silent",
                                                  "sdo_late",
                                                  "sdo_abort",
                                                  "stuck_state",
                                                  "frozen",
                                                  "encoder_loss",
                                                  "emcy",
                                                  "emcy_only",
                                                  "over_current",
                                                  "encoder_fault",
                                                  "encoder_jump",
                                                  "following_error",
                                                  "over_temperature",
                                                  "under_voltage",
                                                  "reset"};

constexpr bool lasts(DriveFaultKind kind) noexcept { return kind <= DriveFaultKind::encoder_loss; }

}  // namespace

std::optional<DriveFaultKind> drive_fault_kind(std::string_view name) noexcept {
  const auto found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return std::nullopt;
  return static_cast<DriveFaultKind>(found - std::begin(kNames));
}
std::string_view name_of(DriveFaultKind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

void SimulatedDrive::Inside::power_on(Nanoseconds t) noexcept {
  now = t;
  next_servo = t + config.servo_period_ns;
  next_communication = t + kCommunicationPeriod;
  const std::int64_t encoder = plant.state().position;
  profile.power_on(encoder, config.absolute_encoder ? encoder : 0);
  slave.power_on(gate, t, static_cast<Nanoseconds>(config.boot_time_s * 1e9));
}

void SimulatedDrive::Inside::advance_to(Nanoseconds t) noexcept {
  while (next_servo <= t || next_communication <= t) {
    if (spoiled(DriveFaultKind::frozen)) {
      // Time passes it by.
      next_servo += next_servo <= t ? config.servo_period_ns : 0;
      if (next_communication > t) continue;
      expire(next_communication);
      next_communication += kCommunicationPeriod;
    } else if (next_servo <= next_communication) {
      if (late_count > 0) hear_late(next_servo);
      servo_tick();
      next_servo += config.servo_period_ns;
    } else {
      if (any_lasting) expire(next_communication);
      gate.advance_to(next_communication);
      slave.tick(next_communication);
      next_communication += kCommunicationPeriod;
    }
  }
  if (late_count > 0 && !spoiled(DriveFaultKind::frozen)) hear_late(t);
  now = std::max(now, t);
}

void SimulatedDrive::Inside::hear_late(Nanoseconds t) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < late_count; ++i) {
    const CanFrame frame = late[i];
    if (frame.timestamp_ns > t)
      late[kept++] = frame;
    else
      slave.on_frame(frame, frame.timestamp_ns);
  }
  late_count = kept;
}

// False: the frame does not get through now.
bool SimulatedDrive::Inside::spoil_rpdo(CanFrame& frame) noexcept {
  const auto number = static_cast<std::uint32_t>(slave.receive_pdo_of(frame));
  const auto hit = [&](DriveFaultKind kind) {
    return spoiled(kind) && (fault(kind).number == 0 || fault(kind).number == number);
  };
  if (number == 0) return true;
  if (hit(DriveFaultKind::rpdo_dropped) &&
      ++rpdos_dropped_of % std::max<std::uint32_t>(1, fault(DriveFaultKind::rpdo_dropped).every) == 0)
    return false;
  if (hit(DriveFaultKind::rpdo_corrupted)) {
    const auto bytes = std::span(frame.data).first(std::min<std::size_t>(frame.length, 8));
    canopen::store_le(
        canopen::load_le(bytes) ^ static_cast<std::uint64_t>(fault(DriveFaultKind::rpdo_corrupted).value),
        bytes);
  }
  if (!hit(DriveFaultKind::rpdo_late)) return true;
  frame.timestamp_ns += fault(DriveFaultKind::rpdo_late).delay_ns;
  if (late_count < late.size()) late[late_count++] = frame;
  return false;
}

// I2t. Source: CiA 402-1, error code 2350h "load level fault (I2t, thermal state)".
void SimulatedDrive::Inside::watch_heat() noexcept {
  constexpr double kTooHot = 1.0, kCooledDown = 0.9;
  const double heat = plant.thermal();
  if (heat > kTooHot && !hot) {
    hot = true;
    profile.hold_fault(true);
    profile.fault(0x2350, false);
  } else if (heat < kCooledDown && hot) {
    hot = false;
    profile.hold_fault(false);
  }
}

void SimulatedDrive::Inside::servo_tick() noexcept {
  const std::int64_t before = plant.counts();
  plant.step(command);
  if (config.plant.thermal_time_s > 0.0) watch_heat();
  read_inputs(before);
  inputs.hold_state = any_lasting && spoiled(DriveFaultKind::stuck_state) &&
                      profile.state() == fault(DriveFaultKind::stuck_state).state;
  if (any_lasting && spoiled(DriveFaultKind::encoder_loss)) {
    canopen::ServoState servo = plant.state();
    servo.position = lost_encoder_position;
    servo.zero_mark = false;
    command = profile.tick(servo, inputs);
  } else {
    command = profile.tick(plant.state(), inputs);
  }
}

// Levels of the inputs; where the shaft itself moved a switch, the edge lies on the switch's boundary.
void SimulatedDrive::Inside::read_inputs(std::int64_t before) noexcept {
  if (config.switches.empty() && outside_level == inputs.active) return;
  const std::int64_t error = plant.state().position - plant.counts();
  auto level = outside_level;
  auto edge = inputs.edge_position;
  edge.fill(plant.state().position);
  for (const DriveSwitch& s : config.switches) {
    const auto i = static_cast<std::size_t>(s.input);
    const bool was = before >= s.from && before <= s.to, is = inside(s);
    level[i] = level[i] || is;
    if (was == is) continue;
    const bool at_from = is ? before < s.from : plant.counts() < s.from;
    edge[i] = (at_from ? s.from : s.to) + error;
  }
  for (std::size_t i = 0; i < canopen::kDriveInputs; ++i)
    if (level[i] != inputs.active[i]) inputs.edge_position[i] = edge[i];
  inputs.active = level;
}

bool SimulatedDrive::Inside::answer_with_abort(const CanFrame& frame) noexcept {
  if (!any_lasting || !spoiled(DriveFaultKind::sdo_abort)) return false;
  if (frame.id != canopen::cob::sdo_request(slave.node()) || frame.length != 8) return false;
  const DriveFault& f = fault(DriveFaultKind::sdo_abort);
  const auto index = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  if (f.index != 0 && f.index != index) return false;
  const auto answer = canopen::sdo_abort(index, frame.data[3], f.abort);
  gate.send(canopen::make_frame(canopen::cob::sdo_response(slave.node()), answer));
  return true;
}

void SimulatedDrive::Inside::inject(const DriveFault& f) noexcept {
  if (!lasts(f.kind)) return happen(f);
  lasting[static_cast<std::size_t>(f.kind)] = {f, f.duration_ns > 0 ? now + f.duration_ns : 0, true};
  if (f.kind == DriveFaultKind::rpdo_dropped) rpdos_dropped_of = 0;
  if (f.kind == DriveFaultKind::pdo_dropped) gate.count_pdos_anew();
  if (f.kind == DriveFaultKind::encoder_loss) lost_encoder_position = plant.state().position;
  apply_to_gate();
}

void SimulatedDrive::Inside::clear(DriveFaultKind kind) noexcept {
  lasting[static_cast<std::size_t>(kind)].active = false;
  apply_to_gate();
}

void SimulatedDrive::Inside::expire(Nanoseconds t) noexcept {
  bool changed = false;
  for (Lasting& l : lasting) {
    if (!l.active || l.until == 0 || t < l.until) continue;
    l.active = false;
    changed = true;
  }
  if (changed) apply_to_gate();
}

void SimulatedDrive::Inside::apply_to_gate() noexcept {
  any_lasting = std::any_of(lasting.begin(), lasting.end(), [](const Lasting& l) { return l.active; });
  BusGate::Spoil& s = gate.spoil();
  s.silent = spoiled(DriveFaultKind::silent) || spoiled(DriveFaultKind::frozen);
  s.heartbeat_lost = spoiled(DriveFaultKind::heartbeat_lost);
  s.sdo_delay_ns = spoiled(DriveFaultKind::sdo_late) ? fault(DriveFaultKind::sdo_late).delay_ns : 0;
  s.sdo_silent = spoiled(DriveFaultKind::sdo_silent);
  s.pdo_repeated = spoiled(DriveFaultKind::pdo_repeated);
  const auto number = [this](DriveFaultKind kind) { return spoiled(kind) ? fault(kind).number : 0; };
  s.dropped_number = number(DriveFaultKind::pdo_dropped);
  s.late_number = number(DriveFaultKind::pdo_late);
  s.flipped_number = number(DriveFaultKind::pdo_corrupted);
  s.repeated_number = number(DriveFaultKind::pdo_repeated);
  const DriveFault& dropped = fault(DriveFaultKind::pdo_dropped);
  s.pdo_dropped_every = spoiled(DriveFaultKind::pdo_dropped) ? std::max<std::uint32_t>(1, dropped.every) : 0;
  s.pdo_delay_ns = spoiled(DriveFaultKind::pdo_late) ? fault(DriveFaultKind::pdo_late).delay_ns : 0;
  s.pdo_flip = spoiled(DriveFaultKind::pdo_corrupted)
                   ? static_cast<std::uint64_t>(fault(DriveFaultKind::pdo_corrupted).value)
                   : 0;
}

void SimulatedDrive::Inside::happen(const DriveFault& f) noexcept {
  switch (f.kind) {
    case DriveFaultKind::emcy:
      return profile.fault(f.error_code, false);
    case DriveFaultKind::emcy_only:
      return slave.emcy().notify(f.error_code);
    case DriveFaultKind::over_current:
      return profile.fault(0x2310, true);
    case DriveFaultKind::encoder_fault:
      return profile.fault(0x7305, true);
    case DriveFaultKind::encoder_jump:
      return plant.jump_encoder(f.value);
    case DriveFaultKind::following_error:
      return profile.fault(0x8611, false);
    case DriveFaultKind::over_temperature:
      return profile.fault(0x4310, false);
    case DriveFaultKind::under_voltage:
      return profile.fault(0x3220, true);
    case DriveFaultKind::reset:
      slave.reset_node(now);
      return power_on(now);
    default:
      return;
  }
}

}  // namespace servogate::mock
