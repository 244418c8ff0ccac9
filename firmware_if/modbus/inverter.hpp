// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_if/modbus/pdu.hpp"

namespace servogate::modbus {

/// Bits of a word and what they are when something is so.
struct Match {
  std::uint16_t mask = 0, value = 0;
  bool known() const noexcept { return mask != 0; }
  bool of(std::uint16_t word) const noexcept { return known() && (word & mask) == value; }
};

/// A register that must hold a value from `low` to `high` before the inverter may turn its motor.
struct RequiredRegister {
  std::uint16_t address = 0, low = 0, high = 0xFFFF;
};

/// The registers of an inverter as its manual has them. Addresses as on the wire.
struct InverterRegisters {
  Coding coding = Coding::standard;
  Function read = Function::read_holding_registers;
  Function write = Function::write_single_register;
  std::uint16_t command = 0, frequency = 0;
  std::uint16_t forward = 1, stop = 0;         ///< values of the command
  std::optional<std::uint16_t> reverse;        ///< nullopt: turns one way only
  std::optional<std::uint16_t> reset;          ///< clears a trip; 0 is written before and behind it
  std::optional<std::uint16_t> reset_address;  ///< nullopt: a value of the command
  std::optional<std::uint16_t> status, output, fault;
  Match running, at_speed, reversed, tripped, ready;  ///< of the status
  std::uint16_t fault_mask = 0xFFFF;                  ///< bits of the trip code; 0 in them: no trip
  double frequency_unit = 0.01;                       ///< Hz of 1 in the frequency
  double output_unit = 0.01;                          ///< Hz of 1 in the output frequency
  std::vector<RequiredRegister> required;
};

/// Where a register lies in the blocks of a line.
struct Spot {
  std::size_t block = 0;
  std::uint16_t offset = 0;
};

/// An inverter on a line, and the spindle that it turns.
struct Inverter {
  std::uint8_t unit = 1;
  int spindle = 0;  ///< in ProcessImage::spindles
  InverterRegisters registers;
  double counts_s_per_hz = 1.0;            ///< of the spindle's drive counts, + clockwise
  std::size_t command = 0, frequency = 0;  ///< blocks of one register, written
  std::optional<std::size_t> reset;        ///< the same
  std::optional<Spot> status, output, fault;
  std::vector<Spot> required;  ///< as in the registers
};

}  // namespace servogate::modbus
