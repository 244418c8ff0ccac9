// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace servogate::machine {

enum class InverterProtocol : std::uint8_t { modbus, huanyang };

/// [[inverter.required]]: a register that must have a value from `low` to `high`, or nothing turns.
struct InverterRequired {
  int address = 0;
  int low = 0;
  int high = 65535;
  std::string english, russian;  ///< what it is, and to what it is set
};

/// [inverter]: the registers of an inverter as its manual has them; -1: it has none. A pair is bits of the
/// status and what they are when it is so.
struct InverterMap {
  InverterProtocol protocol = InverterProtocol::modbus;
  int read_function = 3;
  int write_function = 6;
  int command = -1;
  int forward = 1, reverse = -1, stop = 0;
  int frequency = -1;
  double frequency_unit = 0.01;  ///< Hz
  int reset = -1;
  int reset_address = -1;
  int status = -1;
  std::array<std::int64_t, 2> running = {0, 0}, at_speed = {0, 0}, reversed = {0, 0}, tripped = {0, 0},
                              ready = {0, 0};
  int output = -1;
  double output_unit = 0.01;  ///< Hz
  int fault = -1;
  int fault_mask = 65535;
  bool read_together = true;  ///< from the first to the last register of its state in one request
  int silence_fault = 0;      ///< of the simulated one: its trip when nobody asks it any more
  std::vector<InverterRequired> required;
};

}  // namespace servogate::machine
