// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/simulated_drive.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/mock/drive/drive_inside.hpp"

namespace servogate::mock {
namespace {

canopen::ServoProfileSettings settings_of(const SimulatedDriveConfig& c) {
  const bool brake = c.plant.brake_torque_nm > 0.0;
  const auto ns = [brake](double s) { return brake ? static_cast<Nanoseconds>(std::llround(s * 1e9)) : 0; };
  canopen::ServoProfileSettings s;
  s.servo_period = c.servo_period_ns;
  s.counts_per_rev = c.plant.counts_per_rev;
  s.brake_release = ns(c.plant.brake_release_s);
  s.brake_engage = ns(c.plant.brake_engage_s);
  s.quirks = c.quirks;
  return s;
}

}  // namespace

SimulatedDrive::Inside::Inside(const SimulatedDriveConfig& c)
    : config(c),
      objects(device_objects(c)),
      dictionary({objects.rows}),
      profile(dictionary, settings_of(c)),
      slave(c.node_id, dictionary, profile),
      plant(c.plant, c.servo_period_ns) {
  profile.connect(slave.emcy());
  slave.let_change_maps(c.map_access);
  if (c.program_memory > 0) {
    programs.emplace(dictionary, c.program_memory, canopen::ProgramStore::Times{});
    slave.use(*programs);
  }
  for (const canopen::ObjectSpec& row : objects.hidden)
    dictionary.hide(dictionary.find(row.index, row.subindex));
  inputs.main_voltage = c.main_voltage;
  for (const DriveSwitch& s : config.switches) inputs.active[static_cast<std::size_t>(s.input)] |= inside(s);
}

SimulatedDrive::SimulatedDrive(const SimulatedDriveConfig& config)
    : inside_(std::make_unique<Inside>(config)) {}
SimulatedDrive::~SimulatedDrive() = default;

void SimulatedDrive::connect(image::CanBus& bus, Nanoseconds now) {
  inside_->gate.connect(bus);
  inside_->power_on(now);
}

const CanFilter* SimulatedDrive::filter() const noexcept { return &inside_->slave.filter(); }

void SimulatedDrive::on_frame(const CanFrame& frame) noexcept {
  Inside& in = *inside_;
  if (!in.slave.concerned(frame)) return;
  if (in.any_lasting &&
      (in.spoiled(fault::Kind::deaf) || in.spoiled(fault::Kind::freeze) || in.spoiled(fault::Kind::kill)))
    return;
  if (in.due(frame.timestamp_ns) && in.slave.immediate(frame)) in.advance_to(frame.timestamp_ns);
  if (in.any_lasting) {
    CanFrame spoiled = frame;
    if (in.answer_with_abort(frame) || !in.spoil_rpdo(spoiled)) return;
    return in.slave.on_frame(spoiled, frame.timestamp_ns);
  }
  in.slave.on_frame(frame, frame.timestamp_ns);
}

void SimulatedDrive::advance_to(Nanoseconds t) noexcept { inside_->advance_to(t); }
Nanoseconds SimulatedDrive::next_action_ns() const noexcept { return inside_->next_communication; }
bool SimulatedDrive::alive() const noexcept { return !inside_->spoiled(fault::Kind::kill); }

canopen::NodeId SimulatedDrive::node_id() const noexcept { return inside_->slave.node(); }
image::DriveState SimulatedDrive::state() const noexcept { return inside_->profile.state(); }
canopen::NmtState SimulatedDrive::nmt_state() const noexcept { return inside_->slave.state(); }
std::uint16_t SimulatedDrive::statusword() const noexcept { return inside_->profile.statusword(); }
std::uint16_t SimulatedDrive::error_code() const noexcept { return inside_->profile.error_code(); }
bool SimulatedDrive::brake_released() const noexcept { return inside_->command.brake_released; }
double SimulatedDrive::revolutions() const noexcept { return inside_->plant.revolutions(); }
std::int64_t SimulatedDrive::position_counts() const noexcept { return inside_->plant.counts(); }
double SimulatedDrive::velocity_counts_s() const noexcept { return inside_->plant.state().velocity; }
double SimulatedDrive::thermal() const noexcept { return inside_->plant.thermal(); }
const std::vector<ObjectPlace>& SimulatedDrive::left_out() const noexcept {
  return inside_->objects.left_out;
}
double SimulatedDrive::torque_permille() const noexcept { return inside_->plant.state().torque; }
std::int64_t SimulatedDrive::reported_position() const noexcept { return inside_->profile.position(); }

void SimulatedDrive::set_input(DriveSwitch::Input input, bool active) noexcept {
  inside_->outside_level[static_cast<std::size_t>(input)] = active;
}
void SimulatedDrive::set_interlock(bool active) noexcept { inside_->inputs.interlock = active; }
void SimulatedDrive::set_general_inputs(std::uint16_t bits) noexcept { inside_->inputs.general = bits; }
std::uint32_t SimulatedDrive::digital_outputs() const noexcept {
  const auto& od = inside_->dictionary;
  return static_cast<std::uint32_t>(od.get(canopen::object::kDigitalOutputs, 1) &
                                    od.get(canopen::object::kDigitalOutputs, 2));
}
void SimulatedDrive::set_load_torque(double nm) noexcept { inside_->plant.set_load_torque(nm); }
void SimulatedDrive::set_main_voltage(bool present) noexcept { inside_->inputs.main_voltage = present; }
void SimulatedDrive::set_safe_torque_off(bool torque_allowed) noexcept {
  inside_->inputs.torque_allowed = torque_allowed;
}

void SimulatedDrive::inject(const fault::Fault& fault) noexcept { inside_->inject(fault); }
void SimulatedDrive::clear(fault::Kind kind) noexcept { inside_->clear(kind); }
void SimulatedDrive::clear_faults() noexcept {
  for (std::size_t i = 0; i < fault::kKinds; ++i) inside_->clear(static_cast<fault::Kind>(i));
}
void SimulatedDrive::spoil_next_program(std::uint8_t flash_error) noexcept {
  if (inside_->programs) inside_->programs->spoil_next_write(flash_error);
}
bool SimulatedDrive::faulted_with(fault::Kind kind) const noexcept { return inside_->spoiled(kind); }

std::int64_t SimulatedDrive::object(std::uint16_t index, std::uint8_t subindex) noexcept {
  inside_->profile.refresh();
  return inside_->dictionary.get(index, subindex);
}

void PolledDrive::advance_to(Nanoseconds t) {
  CanFrame frame;
  while (bus_.receive(frame)) {
    frame.timestamp_ns = std::min(frame.timestamp_ns, t);
    drive_.on_frame(frame);
  }
  drive_.advance_to(t);
}

}  // namespace servogate::mock
