// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "firmware_if/modbus/coalesce.hpp"
#include "machine/modbus_blocks.hpp"

namespace servogate::machine {

namespace {

/// So many registers are read with holes between them rather than one by one.
constexpr int kTogether = 16;

std::optional<std::uint16_t> perhaps(int address) {
  if (address < 0) return std::nullopt;
  return static_cast<std::uint16_t>(address);
}

modbus::Match match_of(const std::array<std::int64_t, 2>& pair) {
  return {static_cast<std::uint16_t>(pair[0]), static_cast<std::uint16_t>(pair[1])};
}

/// Lays the registers of an inverter into blocks.
class Layout {
 public:
  Layout(const StationConfig& station, const InverterMap& map) : map_(map) {
    out_.inverter.unit = static_cast<std::uint8_t>(station.unit);
    out_.inverter.registers = inverter_registers(map);
    period_ = static_cast<image::Nanoseconds>(std::llround(station.period * 1e9));
  }

  InverterBlocks all() {
    modbus::Inverter& i = out_.inverter;
    i.frequency = written(i.registers.frequency);
    i.command = written(i.registers.command);
    if (i.registers.reset_address) i.reset = written(*i.registers.reset_address);
    state();
    for (const modbus::RequiredRegister& r : i.registers.required)
      i.required.push_back({read(r.address, 1, kRequiredPeriod), 0});
    return std::move(out_);
  }

 private:
  std::size_t add(modbus::Function function, std::uint16_t address, int count, image::Nanoseconds period) {
    const modbus::InverterRegisters& r = out_.inverter.registers;
    out_.blocks.push_back(
        {out_.inverter.unit, function, address, static_cast<std::uint16_t>(count), period, r.coding});
    return out_.blocks.size() - 1;
  }
  std::size_t written(std::uint16_t address) {
    return add(out_.inverter.registers.write, address, 1, period_);
  }
  std::size_t read(std::uint16_t address, int count, image::Nanoseconds period) {
    const modbus::InverterRegisters& r = out_.inverter.registers;
    const bool own = r.coding == modbus::Coding::huanyang && period == kRequiredPeriod;
    return add(own ? modbus::Function::read_holding_registers : r.read, address, count, period);
  }

  void state() {
    modbus::Inverter& i = out_.inverter;
    const bool own = i.registers.coding == modbus::Coding::huanyang;
    // Of its own requests the answer to the command tells the status.
    const bool told = own && i.registers.status == i.registers.command;
    if (told) i.status = modbus::Spot{i.command, 0};
    std::vector<std::pair<std::uint16_t, std::optional<modbus::Spot>*>> wanted;
    if (i.registers.status && !told) wanted.emplace_back(*i.registers.status, &i.status);
    if (i.registers.output) wanted.emplace_back(*i.registers.output, &i.output);
    if (i.registers.fault) wanted.emplace_back(*i.registers.fault, &i.fault);
    if (wanted.empty()) return;
    const auto [low, high] = std::minmax_element(wanted.begin(), wanted.end());
    const int first = low->first, span = high->first - first + 1;
    if (map_.read_together && !own && span <= kTogether) {
      const std::size_t block = read(static_cast<std::uint16_t>(first), span, period_);
      for (auto& [address, spot] : wanted)
        *spot = modbus::Spot{block, static_cast<std::uint16_t>(address - first)};
      return;
    }
    for (auto& [address, spot] : wanted) *spot = modbus::Spot{read(address, 1, period_), 0};
  }

  const InverterMap& map_;
  InverterBlocks out_;
  image::Nanoseconds period_ = 0;
};

}  // namespace

modbus::InverterRegisters inverter_registers(const InverterMap& m) {
  modbus::InverterRegisters r;
  const bool own = m.protocol == InverterProtocol::huanyang;
  r.coding = own ? modbus::Coding::huanyang : modbus::Coding::standard;
  r.read = static_cast<modbus::Function>(own ? 4 : m.read_function);
  r.write = static_cast<modbus::Function>(own ? 6 : m.write_function);
  r.command = static_cast<std::uint16_t>(m.command);
  r.frequency = static_cast<std::uint16_t>(m.frequency);
  r.forward = static_cast<std::uint16_t>(m.forward);
  r.stop = static_cast<std::uint16_t>(m.stop);
  r.reverse = perhaps(m.reverse);
  r.reset = perhaps(m.reset);
  r.reset_address = perhaps(m.reset_address);
  r.status = perhaps(m.status);
  r.output = perhaps(m.output);
  r.fault = perhaps(m.fault);
  r.running = match_of(m.running);
  r.at_speed = match_of(m.at_speed);
  r.reversed = match_of(m.reversed);
  r.tripped = match_of(m.tripped);
  r.ready = match_of(m.ready);
  r.fault_mask = static_cast<std::uint16_t>(m.fault_mask);
  r.frequency_unit = m.frequency_unit;
  r.output_unit = m.output_unit;
  for (const InverterRequired& q : m.required)
    r.required.push_back({static_cast<std::uint16_t>(q.address), static_cast<std::uint16_t>(q.low),
                          static_cast<std::uint16_t>(q.high)});
  return r;
}

InverterBlocks inverter_blocks(const StationConfig& station, const InverterMap& layout) {
  return Layout(station, layout).all();
}

}  // namespace servogate::machine
