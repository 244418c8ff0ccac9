// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>

#include "firmware_if/image/time.hpp"
#include "firmware_if/modbus/inverter.hpp"

namespace servogate::mock {

/// A simulated inverter: its registers, and how its motor runs.
struct SimulatedInverterSettings {
  modbus::InverterRegisters registers;
  double max_hz = 400.0;           ///< a higher wish is cut
  double ramp_hz_s = 100.0;        ///< up and down
  std::uint16_t silence_trip = 0;  ///< trip code when its watchdog has run off; 0: it only stops
};

/// An inverter with its motor as a server on bytes: runs up and down on its ramp, through standstill into the
/// other direction, cuts a frequency that is too high, is at speed when it is there, and coasts when it
/// trips. While it has tripped it takes no command but the reset, which needs the cause gone. What stands in
/// its registers is what its data say; other addresses between the first and the last one of its state read
/// as 0, all others do not exist. Times are simulated.
class SimulatedInverter {
 public:
  explicit SimulatedInverter(SimulatedInverterSettings settings);

  /// Serves one request. False: that is none for it, and nothing is answered.
  bool serve(const modbus::Pdu& request, modbus::Pdu& answer);
  void advance_to(image::Nanoseconds t);

  /// Protection works: the output goes off, the motor coasts.
  void trip(std::uint16_t code);
  /// Nobody asks it any more: it stops on its ramp, and trips where that is its setting.
  void fall_silent();
  /// Its supply is gone: nothing of its registers stays but parameters.
  void lose_supply();
  /// A parameter at its keypad.
  void set_register(std::uint16_t address, std::uint16_t value) { parameters_[address] = value; }

  double output_hz() const noexcept { return output_; }  ///< + forward; what it feeds the motor with
  double motor_hz() const noexcept { return motor_; }    ///< the motor's speed; coasts when the output is off
  bool runs() const noexcept { return direction_ != 0; }
  std::uint16_t tripped() const noexcept { return trip_; }  ///< code, 0: no

 private:
  modbus::Response answer_to(const modbus::Request& asked);
  std::uint16_t word_at(const modbus::Request& asked, std::uint16_t address, bool& there) const;
  bool write(std::uint16_t address, std::uint16_t value);
  void command(std::uint16_t value);
  std::uint16_t status() const;

  SimulatedInverterSettings settings_;
  std::map<std::uint16_t, std::uint16_t> parameters_;
  std::uint16_t command_ = 0, frequency_ = 0, trip_ = 0;
  int direction_ = 0;                  ///< that was commanded; 0: stop
  double output_ = 0.0, motor_ = 0.0;  ///< Hz
  image::Nanoseconds now_ns_ = 0;
};

}  // namespace servogate::mock
