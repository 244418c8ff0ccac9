// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/modbus/simulated_inverter.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/modbus/huanyang.hpp"

namespace servogate::mock {

using modbus::Exception;
using modbus::Function;
using modbus::Match;

namespace {

constexpr double kAtSpeed_hz = 0.1;
/// A motor without current needs longer than on the ramp.
constexpr double kCoast = 0.5;

double toward(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }

std::uint16_t raw(double hz, double unit) {
  return static_cast<std::uint16_t>(std::clamp(std::round(std::abs(hz) / unit), 0.0, 65535.0));
}

void put(const Match& match, bool is, std::uint16_t& word) {
  if (!match.known()) return;
  const unsigned other = match.value == 0 ? match.mask : 0u;
  word = static_cast<std::uint16_t>((word & ~unsigned{match.mask}) | (is ? match.value : other));
}

}  // namespace

SimulatedInverter::SimulatedInverter(SimulatedInverterSettings settings) : settings_(std::move(settings)) {
  command_ = settings_.registers.stop;
  for (const modbus::RequiredRegister& r : settings_.registers.required) parameters_[r.address] = r.low;
}

bool SimulatedInverter::serve(const modbus::Pdu& request, modbus::Pdu& answer) {
  modbus::Request asked;
  modbus::Response response;
  const bool own = settings_.registers.coding == modbus::Coding::huanyang;
  response.exception = own ? modbus::huanyang::decode_request(request.view(), asked)
                           : modbus::decode_request(request.view(), asked);
  if (response.exception == Exception::none)
    response = answer_to(asked);
  else
    response.function = static_cast<Function>(request.size > 0 ? request.bytes[0] & 0x7F : 0);
  return own ? modbus::huanyang::encode(response, answer) : modbus::encode(response, answer);
}

modbus::Response SimulatedInverter::answer_to(const modbus::Request& asked) {
  modbus::Response r{asked.function, Exception::none, asked.address, asked.count, asked.data};
  const modbus::InverterRegisters& registers = settings_.registers;
  const bool writes = modbus::writes(asked.function);
  const bool reads = asked.function == registers.read || asked.function == Function::read_holding_registers;
  if (modbus::carries_bits(asked.function) || (!writes && !reads)) r.exception = Exception::illegal_function;
  for (std::uint16_t n = 0; n < asked.count && r.exception == Exception::none; ++n) {
    const auto address = static_cast<std::uint16_t>(asked.address + n);
    bool there = true;
    if (writes)
      there = write(address, asked.data.words[n]);
    else
      r.data.words[n] = word_at(asked, address, there);
    if (!there) r.exception = Exception::illegal_data_address;
  }
  // Of its own requests the answer to a command says how it is.
  if (registers.coding == modbus::Coding::huanyang && writes && asked.address == registers.command)
    r.data.words[0] = status();
  return r;
}

std::uint16_t SimulatedInverter::word_at(const modbus::Request& asked, std::uint16_t address,
                                         bool& there) const {
  const modbus::InverterRegisters& r = settings_.registers;
  // Its own requests count parameters and values of the status apart.
  const bool own = r.coding == modbus::Coding::huanyang;
  const bool of_parameters = !own || asked.function == Function::read_holding_registers;
  if (const auto p = parameters_.find(address); of_parameters && p != parameters_.end()) return p->second;
  if (own && of_parameters) return 0;
  if (address == r.output) return raw(output_, r.output_unit);
  if (address == r.status) return status();
  if (address == r.fault) return trip_;
  if (address == r.command) return command_;
  if (address == r.frequency) return frequency_;
  std::uint16_t first = 0xFFFF, last = 0;
  for (const auto& of : {r.status, r.output, r.fault})
    if (of) first = std::min(first, *of), last = std::max(last, *of);
  there = address > first && address < last;
  return 0;
}

bool SimulatedInverter::write(std::uint16_t address, std::uint16_t value) {
  const modbus::InverterRegisters& r = settings_.registers;
  if (address == r.frequency) {
    frequency_ = value;
    return true;
  }
  if (address == r.command) {
    command(value);
    return true;
  }
  if (address != r.reset_address) return false;
  if (value == r.reset) trip_ = 0;
  return true;
}

void SimulatedInverter::command(std::uint16_t value) {
  const modbus::InverterRegisters& r = settings_.registers;
  command_ = value;
  if (!r.reset_address && value == r.reset) trip_ = 0;
  direction_ = trip_ != 0 ? 0 : value == r.forward ? 1 : value == r.reverse ? -1 : 0;
}

std::uint16_t SimulatedInverter::status() const {
  const modbus::InverterRegisters& r = settings_.registers;
  const double wanted = std::min(frequency_ * r.frequency_unit, settings_.max_hz) * direction_;
  std::uint16_t word = 0;
  put(r.running, direction_ != 0 || output_ != 0.0, word);
  put(r.at_speed, direction_ != 0 && std::abs(output_ - wanted) <= kAtSpeed_hz, word);
  put(r.reversed, output_ < 0.0 || (output_ == 0.0 && direction_ < 0), word);
  put(r.tripped, trip_ != 0, word);
  put(r.ready, trip_ == 0, word);
  return word;
}

void SimulatedInverter::advance_to(image::Nanoseconds t) {
  const double dt = static_cast<double>(std::max<image::Nanoseconds>(0, t - now_ns_)) * 1e-9;
  now_ns_ = std::max(now_ns_, t);
  const double step = settings_.ramp_hz_s * dt;
  if (trip_ != 0) {
    output_ = 0.0;
    motor_ = toward(motor_, 0.0, kCoast * step);
    return;
  }
  const double wish = std::min(frequency_ * settings_.registers.frequency_unit, settings_.max_hz);
  output_ = toward(output_, wish * direction_, step);
  motor_ = toward(motor_, output_, 2.0 * step);
}

void SimulatedInverter::trip(std::uint16_t code) {
  trip_ = code;
  direction_ = 0;
  output_ = 0.0;
}

void SimulatedInverter::fall_silent() {
  if (direction_ != 0 && settings_.silence_trip != 0) return trip(settings_.silence_trip);
  direction_ = 0;
}

void SimulatedInverter::lose_supply() {
  command_ = settings_.registers.stop;
  frequency_ = trip_ = 0;
  direction_ = 0;
  output_ = 0.0;
}

}  // namespace servogate::mock
