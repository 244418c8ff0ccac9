// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/inverter_control.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::modbus {

using image::DriveState;

namespace {

/// The first answer may be that to what was written before.
constexpr int kResetWrites = 3, kArrival = 2;
/// Statusword bits of CiA 402-2, 8.4.3, that stand for what the inverter says.
constexpr std::uint16_t kRemote = 0x0200, kTargetReached = 0x0400;

std::uint16_t statusword(DriveState state) noexcept {
  switch (state) {
    case DriveState::operation_enabled:
      return 0x0037 | kRemote;
    case DriveState::ready_to_switch_on:
      return 0x0031 | kRemote;
    case DriveState::fault:
      return 0x0008 | kRemote;
    case DriveState::offline:
      return 0;
    default:
      return 0x0040 | kRemote;
  }
}

}  // namespace

InverterControl::InverterControl(Inverter inverter)
    : inverter_(std::move(inverter)), required_(inverter_.required.size()) {
  command_.block = inverter_.command;
  frequency_.block = inverter_.frequency;
  if (inverter_.reset) reset_.block = *inverter_.reset;
}

bool InverterControl::writes_to(std::size_t block) const noexcept {
  return block == inverter_.command || block == inverter_.frequency || block == inverter_.reset;
}

void InverterControl::take(const Outcome& outcome) noexcept {
  if (!outcome.good) return;
  const auto from = [&](const std::optional<Spot>& spot, std::uint16_t& word) {
    if (spot && spot->block == outcome.block) word = outcome.data.words[spot->offset];
  };
  from(inverter_.status, status_);
  from(inverter_.output, output_);
  from(inverter_.fault, fault_);
  if (outcome.block == inverter_.frequency && frequency_left_ > 0) --frequency_left_;
  const std::optional<Spot>& told = inverter_.status ? inverter_.status : inverter_.output;
  if (told && told->block == outcome.block && frequency_left_ == 0) status_since_ = true;
  for (std::size_t n = 0; n < required_.size(); ++n) from(inverter_.required[n], required_[n]);
  if (reset_left_ > 0 && outcome.block == (inverter_.reset ? *inverter_.reset : inverter_.command))
    --reset_left_;
}

/// The first required register that has another value; nullptr: all are right.
const RequiredRegister* InverterControl::wrong_register() const noexcept {
  for (std::size_t n = 0; n < required_.size(); ++n) {
    const RequiredRegister& r = inverter_.registers.required[n];
    if (required_[n] < r.low || required_[n] > r.high) return &r;
  }
  return nullptr;
}

bool InverterControl::tripped() const noexcept {
  const InverterRegisters& r = inverter_.registers;
  return r.tripped.of(status_) || (inverter_.fault && (fault_ & r.fault_mask) != 0 && !r.tripped.known());
}

double InverterControl::output_hz() const noexcept {
  const InverterRegisters& r = inverter_.registers;
  const bool back = r.reversed.known() ? r.reversed.of(status_) : direction_ < 0;
  return (back ? -1.0 : 1.0) * output_ * r.output_unit;
}

DriveState InverterControl::state() const noexcept {
  const InverterRegisters& r = inverter_.registers;
  if (!online_) return DriveState::offline;
  if (tripped()) return DriveState::fault;
  if (wrong_register() != nullptr || (r.ready.known() && !r.ready.of(status_)))
    return DriveState::switch_on_disabled;
  return powered_ ? DriveState::operation_enabled : DriveState::ready_to_switch_on;
}

void InverterControl::receive(image::ProcessImage& image, image::Quality quality) noexcept {
  const InverterRegisters& r = inverter_.registers;
  online_ = quality == image::Quality::good;
  image::DriveFeedback& f = image.spindles[static_cast<std::size_t>(inverter_.spindle)].drive;
  f.online = online_;
  f.state = state();
  f.mode = image::DriveMode::csv;
  f.error_code = 0;
  if (f.state == DriveState::fault) f.error_code = static_cast<std::uint16_t>(fault_ & r.fault_mask);
  if (const RequiredRegister* wrong = wrong_register(); wrong != nullptr && online_ && !tripped())
    f.error_code = wrong->address;
  f.velocity_counts_s = online_ ? output_hz() * inverter_.counts_s_per_hz : 0.0;
  f.statusword = statusword(f.state);
  const bool runs = r.running.known() ? r.running.of(status_) : output_ != 0;
  if (online_ && runs && status_since_ && (!r.at_speed.known() || r.at_speed.of(status_)))
    f.statusword |= kTargetReached;
}

void InverterControl::write(Written& to, std::uint16_t value, image::Nanoseconds t,
                            WriteSink& sink) noexcept {
  if (to.armed && to.data.words[0] == value) return;
  to.armed = true;
  to.data.words[0] = value;
  sink.write(to.block, to.data, t);
}

void InverterControl::send(const image::ProcessImage& image, WriteSink& sink) noexcept {
  const InverterRegisters& r = inverter_.registers;
  const image::DriveCommand& c = image.spindles[static_cast<std::size_t>(inverter_.spindle)].drive_command;
  powered_ = c.power;
  if (c.reset_fault && !reset_wished_ && online_ && r.reset) reset_left_ = kResetWrites;
  reset_wished_ = c.reset_fault;
  if (!online_) reset_left_ = 0;
  const double hz = c.velocity_counts_s / inverter_.counts_s_per_hz;
  const double steps = std::min(std::round(std::abs(hz) / r.frequency_unit), 65535.0);
  const bool may = state() == DriveState::operation_enabled && !c.quick_stop;
  std::uint16_t command = r.stop;
  if (may && steps > 0.0 && hz > 0.0) command = r.forward;
  if (may && steps > 0.0 && hz < 0.0 && r.reverse) command = *r.reverse;
  const bool runs = command != r.stop;
  if (runs) direction_ = hz < 0.0 ? -1 : 1;
  if (reset_left_ > 0 && !inverter_.reset) command = *r.reset;
  // The speed before the command that lets it turn.
  const auto frequency = static_cast<std::uint16_t>(runs ? steps : 0.0);
  if (frequency_.data.words[0] != frequency) {
    frequency_left_ = kArrival;
    status_since_ = false;
  }
  write(frequency_, frequency, image.now.t_ns, sink);
  write(command_, command, image.now.t_ns, sink);
  if (inverter_.reset) write(reset_, reset_left_ > 0 ? *r.reset : std::uint16_t{0}, image.now.t_ns, sink);
}

void InverterControl::leave(WriteSink& sink) noexcept {
  if (!command_.armed) return;
  write(command_, inverter_.registers.stop, 0, sink);
  write(frequency_, 0, 0, sink);
}

}  // namespace servogate::modbus
