// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/drive_inside.hpp"

#include <algorithm>
#include <numbers>
#include <span>

#include "drivers/mock/drive/servo_loops.hpp"
#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::mock {

SimulatedDrive::Inside::Tuning::Tuning(const canopen::ObjectDictionary& dictionary, bool from_sheet)
    : slots{
          dictionary.find(tuning_object::kVelocityLoop, 1), dictionary.find(tuning_object::kVelocityLoop, 2),
          dictionary.find(tuning_object::kPositionLoop, 1), dictionary.find(tuning_object::kVelocityLoop, 3),
          dictionary.find(tuning_object::kVelocityLoop, 4)} {
  there =
      !from_sheet && std::find(slots.begin(), slots.end(), canopen::ObjectDictionary::kNone) == slots.end();
  if (there) own = values(dictionary);
}

SimulatedDrive::Inside::Tuning::Values SimulatedDrive::Inside::Tuning::values(
    const canopen::ObjectDictionary& dictionary) const noexcept {
  Values out{};
  for (std::size_t i = 0; i < kObjects; ++i) out[i] = dictionary.value(slots[i]);
  return out;
}

// A loop that a master has tuned becomes the torque that it asks for.
const canopen::ServoCommand& SimulatedDrive::Inside::by_own_gains(
    const canopen::ServoCommand& asked) noexcept {
  using Loop = canopen::ServoCommand::Loop;
  const bool closed = asked.loop == Loop::velocity || asked.loop == Loop::position;
  if (!closed) {
    tuning.integral = 0.0;
    tuning.notch.reset();
    return asked;
  }
  if (!tuned_known) {
    tuned_known = true;
    tuned = tuning.there && tuning.values(dictionary) != tuning.own;
  }
  if (!tuned) return asked;
  const Tuning::Values values = tuning.values(dictionary);
  const double step = static_cast<double>(config.servo_period_ns) * 1e-9;
  const double gain = static_cast<double>(values[0]) * 1e-6;
  const ServoGains gains{static_cast<double>(values[2]) * 1e-3, gain,
                         gain * static_cast<double>(values[1]) * 1e-3 * step, total_inertia_of(config.plant),
                         2.0 * std::numbers::pi / static_cast<double>(config.plant.counts_per_rev)};
  tuning.notch.set(static_cast<double>(values[3]) * 1e-3, static_cast<double>(values[4]) * 1e-3, step);
  const double permille = config.plant.rated_torque_nm / 1000.0, peak = config.plant.peak_torque_nm;
  const double high = std::min(asked.torque_limit_positive * permille, peak);
  const double low = -std::min(asked.torque_limit_negative * permille, peak);
  canopen::ServoCommand& out = tuning.command;
  out = asked;
  out.loop = Loop::torque;
  const double torque = servo_torque(gains, asked, asked.torque * permille,
                                     {static_cast<double>(plant.state().position), plant.velocity_rad_s()},
                                     low, high, tuning.integral);
  out.torque = tuning.notch(torque) / permille;
  return out;
}

void SimulatedDrive::Inside::power_on(Nanoseconds t) noexcept {
  now = t;
  next_servo = t + config.servo_period_ns;
  next_communication = t + kCommunicationPeriod;
  const std::int64_t encoder = plant.state().position;
  profile.power_on(encoder, config.absolute_encoder ? encoder : 0);
  slave.power_on(gate, t, static_cast<Nanoseconds>(config.boot_time_s * 1e9));
}

// Everything volatile is gone, and nothing of it is told on the bus.
void SimulatedDrive::Inside::start_again() noexcept {
  gate.spoil().silent = true;
  slave.reset_node(now);
  late_count = 0;
  gate.forget_late();
  command = {};
  power_on(now);
  apply_to_gate();
}

void SimulatedDrive::Inside::show_product(std::int64_t code) noexcept {
  dictionary.set_default(canopen::object::kIdentity, 2, code);
}

inline void SimulatedDrive::Inside::servo_tick() noexcept {
  using Loop = canopen::ServoCommand::Loop;
  const std::int64_t before = plant.counts();
  const bool own_loops =
      tuned_known && !tuned && (command.loop == Loop::position || command.loop == Loop::velocity);
  plant.step(own_loops ? command : by_own_gains(command));
  if (any_lasting && spoiled(fault::Kind::kill)) return;  // the mechanics alone
  if (config.plant.thermal_time_s > 0.0) watch_heat();
  if (!config.switches.empty() || outside_level != inputs.active) read_inputs(before);
  inputs.hold_state = any_lasting && spoiled(fault::Kind::stuck_state) &&
                      profile.state() == fault(fault::Kind::stuck_state).state;
  if (any_lasting && spoiled(fault::Kind::encoder_loss)) {
    canopen::ServoState servo = plant.state();
    servo.position = lost_encoder_position;
    servo.zero_mark = false;
    command = profile.tick(servo, inputs);
  } else {
    command = profile.tick(plant.state(), inputs);
  }
}

void SimulatedDrive::Inside::moving_tick() noexcept {
  const double torque = plant.state().torque;
  rest.forget();
  servo_tick();
  calm = plant.velocity_rad_s() == 0.0 && plant.state().torque == torque;
}

// Many axes stand most of the time, and a tick that changes no bit need not be done again.
void SimulatedDrive::Inside::calm_tick() noexcept {
  profile.drop_target_that_is_met();
  if (rest.before_tick()) return time_at_rest();
  const double torque = plant.state().torque;
  const std::optional<double> before = profile.time_in_window();
  servo_tick();
  calm = plant.state().torque == torque;
  window_runs = profile.only_counts_window(before);
  rest.after_tick(window_runs || profile.time_in_window() == before);
}

// A frame, an input or a fault may have come since the last call.
void SimulatedDrive::Inside::advance_to(Nanoseconds t) noexcept {
  if (!due(t)) {
    now = std::max(now, t);
    return;
  }
  doubt();
  while (next_servo <= t || next_communication <= t) {
    if (any_lasting && spoiled(fault::Kind::freeze) && !spoiled(fault::Kind::kill)) {
      // Time passes it by.
      next_servo += next_servo <= t ? config.servo_period_ns : 0;
      if (next_communication > t) continue;
      expire(next_communication);
      next_communication += kCommunicationPeriod;
    } else if (next_servo <= next_communication) {
      if (late_count > 0) hear_late(next_servo);
      if (rest.sure())
        time_at_rest();
      else if (any_lasting || !calm || plant.velocity_rad_s() != 0.0)
        moving_tick();
      else
        calm_tick();  // it is looked at as a whole
      next_servo += config.servo_period_ns;
    } else {
      if (any_lasting) expire(next_communication);
      if (!spoiled(fault::Kind::kill)) {
        gate.advance_to(next_communication);
        slave.tick(next_communication);
      }
      doubt();
      next_communication += kCommunicationPeriod;
    }
  }
  if (late_count > 0 && !spoiled(fault::Kind::freeze)) hear_late(t);
  now = std::max(now, t);
}

void SimulatedDrive::Inside::hear_late(Nanoseconds t) noexcept {
  doubt();
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
  const auto hit = [&](fault::Kind kind) {
    return spoiled(kind) && (fault(kind).number == 0 || fault(kind).number == number);
  };
  if (number == 0) return true;
  if (hit(fault::Kind::rpdo_dropped) &&
      ++rpdos_dropped_of % std::max<std::uint32_t>(1, fault(fault::Kind::rpdo_dropped).every) == 0)
    return false;
  if (hit(fault::Kind::rpdo_corrupted)) {
    const auto bytes = std::span(frame.data).first(std::min<std::size_t>(frame.length, 8));
    canopen::store_le(
        canopen::load_le(bytes) ^ static_cast<std::uint64_t>(fault(fault::Kind::rpdo_corrupted).value),
        bytes);
  }
  if (!hit(fault::Kind::rpdo_late)) return true;
  frame.timestamp_ns += fault(fault::Kind::rpdo_late).delay_ns;
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

std::span<const std::int64_t> SimulatedDrive::Inside::drive_values() {
  canopen::ObjectDictionary::Slot first = 0;
  while (first < dictionary.size() && dictionary.spec(first).index < 0x6000) ++first;
  if (first == dictionary.size()) return {};
  const canopen::ObjectSpec& spec = dictionary.spec(first);
  // The values stand in the order of their slots.
  return {&dictionary.variable(spec.index, spec.subindex),
          static_cast<std::size_t>(dictionary.size() - first)};
}

// Levels of the inputs; where the shaft itself moved a switch, the edge lies on the switch's boundary.
void SimulatedDrive::Inside::read_inputs(std::int64_t before) noexcept {
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
  if (!any_lasting || !spoiled(fault::Kind::sdo_abort)) return false;
  if (frame.id != canopen::cob::sdo_request(slave.node()) || frame.length != 8) return false;
  const fault::Fault& f = fault(fault::Kind::sdo_abort);
  const auto index = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  if (f.index != 0 && f.index != index) return false;
  const auto answer = canopen::sdo_abort(index, frame.data[3], f.abort);
  gate.send(canopen::make_frame(canopen::cob::sdo_response(slave.node()), answer));
  return true;
}

void SimulatedDrive::Inside::inject(const fault::Fault& f) noexcept {
  if (!fault::row(f.kind).happens_to(fault::Device::drive)) return;
  if (!fault::lasts(f.kind)) return happen(f);
  if (f.kind == fault::Kind::swapped && !spoiled(f.kind))
    own_product = dictionary.get(canopen::object::kIdentity, 2);
  lasting[static_cast<std::size_t>(f.kind)] = {f, f.duration_ns > 0 ? now + f.duration_ns : 0, true};
  begin(f);
  apply_to_gate();
}

void SimulatedDrive::Inside::begin(const fault::Fault& f) noexcept {
  if (f.kind == fault::Kind::rpdo_dropped) rpdos_dropped_of = 0;
  if (f.kind == fault::Kind::pdo_dropped) gate.count_pdos_anew();
  if (f.kind == fault::Kind::encoder_loss) lost_encoder_position = plant.state().position;
  if (f.kind == fault::Kind::swapped) show_product(f.value != 0 ? f.value & 0xFFFF'FFFF : own_product + 1);
  if (f.kind == fault::Kind::swapped || f.kind == fault::Kind::kill) start_again();
  set_supply(f.kind, false);
}

void SimulatedDrive::Inside::clear(fault::Kind kind) noexcept {
  end(lasting[static_cast<std::size_t>(kind)]);
  apply_to_gate();
}

void SimulatedDrive::Inside::end(Lasting& l) noexcept {
  if (!l.active) return;
  l.active = false;
  set_supply(l.fault.kind, true);
  if (l.fault.kind == fault::Kind::swapped) show_product(own_product);
  if (l.fault.kind == fault::Kind::swapped || l.fault.kind == fault::Kind::kill) start_again();
}

// What the faults of the supply take away and give back.
void SimulatedDrive::Inside::set_supply(fault::Kind kind, bool present) noexcept {
  if (kind == fault::Kind::power_cut) inputs.main_voltage = present;
  if (kind == fault::Kind::torque_off) inputs.torque_allowed = present;
}

void SimulatedDrive::Inside::expire(Nanoseconds t) noexcept {
  now = std::max(now, t);
  bool changed = false;
  for (Lasting& l : lasting) {
    if (!l.active || l.until == 0 || t < l.until) continue;
    end(l);
    changed = true;
  }
  if (changed) apply_to_gate();
}

void SimulatedDrive::Inside::apply_to_gate() noexcept {
  any_lasting = std::any_of(lasting.begin(), lasting.end(), [](const Lasting& l) { return l.active; });
  BusGate::Spoil& s = gate.spoil();
  s.silent = spoiled(fault::Kind::silent) || spoiled(fault::Kind::freeze) || spoiled(fault::Kind::kill);
  s.heartbeat_lost = spoiled(fault::Kind::heartbeat_lost);
  s.sdo_delay_ns = spoiled(fault::Kind::sdo_late) ? fault(fault::Kind::sdo_late).delay_ns : 0;
  s.sdo_silent = spoiled(fault::Kind::sdo_silent);
  s.pdo_repeated = spoiled(fault::Kind::pdo_repeated);
  const auto number = [this](fault::Kind kind) { return spoiled(kind) ? fault(kind).number : 0; };
  s.dropped_number = number(fault::Kind::pdo_dropped);
  s.late_number = number(fault::Kind::pdo_late);
  s.flipped_number = number(fault::Kind::pdo_corrupted);
  s.repeated_number = number(fault::Kind::pdo_repeated);
  const fault::Fault& dropped = fault(fault::Kind::pdo_dropped);
  s.pdo_dropped_every = spoiled(fault::Kind::pdo_dropped) ? std::max<std::uint32_t>(1, dropped.every) : 0;
  s.pdo_delay_ns = spoiled(fault::Kind::pdo_late) ? fault(fault::Kind::pdo_late).delay_ns : 0;
  s.pdo_flip = spoiled(fault::Kind::pdo_corrupted)
                   ? static_cast<std::uint64_t>(fault(fault::Kind::pdo_corrupted).value)
                   : 0;
}

void SimulatedDrive::Inside::happen(const fault::Fault& f) noexcept {
  switch (f.kind) {
    case fault::Kind::emcy:
      return profile.fault(f.error_code, false);
    case fault::Kind::emcy_only:
      return slave.emcy().notify(f.error_code);
    case fault::Kind::over_current:
      return profile.fault(0x2310, true);
    case fault::Kind::encoder_fault:
      return profile.fault(0x7305, true);
    case fault::Kind::encoder_jump:
      return plant.jump_encoder(f.value);
    case fault::Kind::following_error:
      return profile.fault(0x8611, false);
    case fault::Kind::over_temperature:
      return profile.fault(0x4310, false);
    case fault::Kind::under_voltage:
      return profile.fault(0x3220, true);
    case fault::Kind::flash_error:
      if (programs) programs->spoil_next_write(static_cast<std::uint8_t>(f.error_code));
      return;
    case fault::Kind::reset:
      slave.reset_node(now);
      return power_on(now);
    default:
      return;
  }
}

}  // namespace servogate::mock
