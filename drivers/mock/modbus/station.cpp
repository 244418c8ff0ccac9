// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/modbus/station.hpp"

#include <algorithm>

namespace servogate::mock {

using modbus::Exception;
using modbus::Function;

ModbusStation::ModbusStation(StationSettings settings) : settings_(std::move(settings)) {
  inputs_.assign(settings_.digital_inputs, false);
  held_.assign(settings_.digital_inputs, false);
  coils_.assign(settings_.digital_outputs, false);
  analog_in_.assign(settings_.analog_inputs, 0);
  holding_.assign(settings_.analog_outputs, 0);
  std::copy_n(settings_.initial_inputs.begin(), std::min(settings_.initial_inputs.size(), inputs_.size()),
              inputs_.begin());
  std::copy_n(settings_.initial_analog.begin(), std::min(settings_.initial_analog.size(), analog_in_.size()),
              analog_in_.begin());
  if (settings_.inverter) inverter_.emplace(*settings_.inverter);
}

void ModbusStation::add_loopback(const Loopback& wire) {
  wires_.push_back({wire, false, false, 0});
  drive(wires_.back(), output(wire.output), now_ns_);
  advance_to(now_ns_);
}

bool ModbusStation::inject(const fault::Fault& fault) {
  if (!fault::row(fault.kind).happens_to(fault::Device::station)) return false;
  if (fault.kind == fault::Kind::trip) {
    if (inverter_) inverter_->trip(fault.error_code);
    return inverter_.has_value();
  }
  if (fault.kind == fault::Kind::parameter) {
    if (inverter_) inverter_->set_register(fault.index, static_cast<std::uint16_t>(fault.value));
    return inverter_.has_value();
  }
  change_fault(fault);
  return true;
}

void ModbusStation::clear_fault() { change_fault(std::nullopt); }

void ModbusStation::change_fault(const std::optional<fault::Fault>& fault) {
  const bool dead = has(fault::Kind::kill), dies = fault && fault->kind == fault::Kind::kill;
  if (dies && !dead) lose_supply();
  // Its watchdog begins to run with its supply.
  if (!dies && dead) last_request_ns_ = now_ns_;
  fault_ = fault;
}

image::Nanoseconds ModbusStation::answer_delay_ns() const noexcept {
  return settings_.answer_delay_ns + (has(fault::Kind::slow) ? fault_->delay_ns : 0);
}

bool ModbusStation::serve(image::Nanoseconds t, const modbus::Pdu& request, modbus::Pdu& answer) {
  advance_to(t);
  if (has(fault::Kind::silent) || has(fault::Kind::kill)) return false;
  ++served_;
  last_request_ns_ = t;
  if (inverter_ && !has(fault::Kind::exception)) return inverter_->serve(request, answer);
  modbus::Request asked;
  modbus::Response response;
  response.exception = has(fault::Kind::exception) ? static_cast<Exception>(fault_->exception)
                                                   : decode_request(request.view(), asked);
  if (response.exception == Exception::none)
    response = answer_to(asked);
  else
    response.function = static_cast<Function>(request.size > 0 ? request.bytes[0] & 0x7F : 0);
  return encode(response, answer);
}

modbus::Response ModbusStation::answer_to(const modbus::Request& asked) {
  modbus::Response r;
  r.function = asked.function;
  r.address = asked.address;
  r.count = asked.count;
  const std::size_t from = asked.address, end = from + asked.count;
  const auto covers = [&](std::size_t first, std::size_t size) {
    const bool inside = from >= first && end <= first + size;
    if (!inside) r.exception = Exception::illegal_data_address;
    return inside;
  };
  const auto bits = [&](const std::vector<bool>& source, std::size_t first) {
    if (!covers(first, source.size())) return;
    for (std::size_t i = from; i < end; ++i) r.data.set_bit(i - from, source[i - first]);
  };
  const std::size_t coils_at = settings_.digital_outputs_at, holding_at = settings_.analog_outputs_at;
  switch (asked.function) {
    case Function::read_coils:
      bits(coils_, coils_at);
      break;
    case Function::read_discrete_inputs:
      if (settings_.inputs_in_registers)
        r.exception = Exception::illegal_data_address;
      else
        bits(inputs_, settings_.digital_inputs_at);
      break;
    case Function::read_holding_registers:
      if (covers(holding_at, holding_.size()))
        for (std::size_t i = from; i < end; ++i) r.data.words[i - from] = holding_[i - holding_at];
      break;
    case Function::read_input_registers:
      for (std::size_t i = from; i < end; ++i)
        if (!input_register(i, r.data.words[i - from])) r.exception = Exception::illegal_data_address;
      break;
    case Function::write_single_coil:
    case Function::write_multiple_coils:
      r.data = asked.data;
      if (covers(coils_at, coils_.size()))
        for (std::size_t i = from; i < end; ++i)
          write_coil(static_cast<std::uint16_t>(i - coils_at), asked.data.bit(i - from), now_ns_);
      break;
    case Function::write_single_register:
    case Function::write_multiple_registers:
      r.data = asked.data;
      if (covers(holding_at, holding_.size()))
        for (std::size_t i = from; i < end; ++i) holding_[i - holding_at] = asked.data.words[i - from];
      break;
  }
  return r;
}

/// The input register at an address: an analog input, or sixteen digital ones. False: there is none.
bool ModbusStation::input_register(std::size_t address, std::uint16_t& word) const noexcept {
  const std::size_t analog = address - settings_.analog_inputs_at;
  if (address >= settings_.analog_inputs_at && analog < analog_in_.size()) {
    word = analog_in_[analog];
    return true;
  }
  const std::size_t first = (address - settings_.digital_inputs_at) * 16;
  if (!settings_.inputs_in_registers || address < settings_.digital_inputs_at || first >= inputs_.size())
    return false;
  word = 0;
  for (std::size_t bit = 0; bit < 16 && first + bit < inputs_.size(); ++bit)
    if (inputs_[first + bit]) word = static_cast<std::uint16_t>(word | 1u << bit);
  return true;
}

void ModbusStation::write_coil(std::uint16_t n, bool on, image::Nanoseconds t) {
  if (coils_[n] == on) return;
  coils_[n] = on;
  for (Wire& wire : wires_)
    if (wire.settings.output == n) drive(wire, on, t);
}

void ModbusStation::drive(Wire& wire, bool out, image::Nanoseconds t) {
  wire.pending = true;
  wire.target = out != wire.settings.inverted;
  wire.due_ns = t + wire.settings.delay_ns;
}

void ModbusStation::advance_to(image::Nanoseconds t) {
  now_ns_ = std::max(now_ns_, t);
  if (inverter_) inverter_->advance_to(now_ns_);
  if (settings_.watchdog_ns > 0 && !has(fault::Kind::kill) &&
      now_ns_ - last_request_ns_ > settings_.watchdog_ns)
    lose_outputs();
  for (Wire& wire : wires_) {
    if (!wire.pending || now_ns_ < wire.due_ns) continue;
    wire.pending = false;
    follow(wire);
  }
}

void ModbusStation::follow(const Wire& wire) {
  if (wire.settings.input < inputs_.size() && !held_[wire.settings.input])
    inputs_[wire.settings.input] = wire.target;
}

void ModbusStation::lose_outputs() {
  if (inverter_) inverter_->fall_silent();
  const auto loss = [](const std::vector<OutputLoss>& list, std::size_t n) {
    return n < list.size() ? list[n] : OutputLoss{};
  };
  for (std::size_t n = 0; n < coils_.size(); ++n)
    if (const OutputLoss l = loss(settings_.coil_loss, n); !l.hold)
      write_coil(static_cast<std::uint16_t>(n), l.value != 0, last_request_ns_ + settings_.watchdog_ns);
  for (std::size_t n = 0; n < holding_.size(); ++n)
    if (const OutputLoss l = loss(settings_.holding_loss, n); !l.hold) holding_[n] = l.value;
}

void ModbusStation::lose_supply() {
  if (inverter_) inverter_->lose_supply();
  for (std::size_t n = 0; n < coils_.size(); ++n) write_coil(static_cast<std::uint16_t>(n), false, now_ns_);
  std::fill(holding_.begin(), holding_.end(), std::uint16_t{0});
}

bool ModbusStation::set_input(std::uint16_t n, bool on) {
  if (n >= inputs_.size()) return false;
  inputs_[n] = on;
  return true;
}

bool ModbusStation::hold_input(std::uint16_t n, bool on) {
  if (!set_input(n, on)) return false;
  held_[n] = true;
  return true;
}

void ModbusStation::let_go_input(std::uint16_t n) {
  if (n >= inputs_.size()) return;
  held_[n] = false;
  for (const Wire& wire : wires_)
    if (wire.settings.input == n && !wire.pending) follow(wire);
}

bool ModbusStation::set_analog_input(std::uint16_t n, std::uint16_t raw) {
  if (n >= analog_in_.size()) return false;
  analog_in_[n] = raw;
  return true;
}

}  // namespace servogate::mock
