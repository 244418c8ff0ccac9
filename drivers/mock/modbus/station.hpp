// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/mock/modbus/simulated_inverter.hpp"
#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/modbus/pdu.hpp"

namespace servogate::mock {

/// What an output of a station does when the station's watchdog has run off.
struct OutputLoss {
  bool hold = false;
  std::uint16_t value = 0;  ///< as on the wire; a coil is on when it is not 0
};

/// Sizes, addresses and initial values of a simulated I/O station. It has discrete inputs, coils, input
/// registers (AI) and holding registers (AO) where it is told, and answers "illegal data address" to
/// everything else.
struct StationSettings {
  std::uint8_t unit = 1;
  std::uint16_t digital_inputs = 16, digital_outputs = 16, analog_inputs = 4, analog_outputs = 2;
  /// Addresses of the first ones, as on the wire; the last ones at 65535 or below.
  std::uint16_t digital_inputs_at = 0, digital_outputs_at = 0, analog_inputs_at = 0, analog_outputs_at = 0;
  /// The digital inputs are bits of input registers, input 0 in bit 0 of the one at digital_inputs_at, and no
  /// discrete inputs. Registers of both kinds do not overlap.
  bool inputs_in_registers = false;
  std::vector<bool> initial_inputs;           ///< missing ones: off
  std::vector<std::uint16_t> initial_analog;  ///< missing ones: 0
  image::Nanoseconds answer_delay_ns =
      2 * image::kMillisecond;  ///< from the request's last byte to the answer's first
  /// Outputs go to their loss values when no request came for so long; 0: they stay.
  image::Nanoseconds watchdog_ns = 0;
  std::vector<OutputLoss> coil_loss, holding_loss;  ///< missing ones: off
  /// It is an inverter, which answers instead of inputs and outputs.
  std::optional<SimulatedInverterSettings> inverter;
};

/// A wire from an output back to an input. A pulse shorter than the delay is swallowed, as a contactor does.
struct Loopback {
  std::uint16_t output = 0;  ///< coil
  std::uint16_t input = 0;   ///< discrete input
  image::Nanoseconds delay_ns = 0;
  bool inverted = false;
};

/// A Modbus I/O station in process: a server on bytes, with wires, a watchdog and faults. Requests have
/// addresses; everything else here counts channels from 0. Times are simulated.
class ModbusStation {
 public:
  explicit ModbusStation(StationSettings settings);

  const StationSettings& settings() const noexcept { return settings_; }
  void add_loopback(const Loopback& wire);
  /// Its one fault from now on: silent (no answer), exception (answers every request with it), slow (answers
  /// `delay_ns` later), corrupt (the answer's checksum is wrong), kill (without supply: no answer, its
  /// outputs are off and stay off until somebody writes them). An inverter may trip, or get another
  /// parameter, beside it. False, and nothing changed: no fault of a station, or that of an inverter at one
  /// that is none.
  bool inject(const fault::Fault& fault);
  void clear_fault();
  const std::optional<fault::Fault>& fault() const noexcept { return fault_; }

  /// nullptr: it is none.
  SimulatedInverter* inverter() noexcept { return inverter_ ? &*inverter_ : nullptr; }

  /// Serves one request that was complete at time t. False: no answer will come.
  bool serve(image::Nanoseconds t, const modbus::Pdu& request, modbus::Pdu& answer);
  /// Time from the request's end to the answer's start, faults included.
  image::Nanoseconds answer_delay_ns() const noexcept;
  /// Moves loop-back wires and the watchdog on to time t.
  void advance_to(image::Nanoseconds t);

  /// Sets a simulated input from outside; false when there is none. A looped input follows its wire again at
  /// the wire's next change.
  bool set_input(std::uint16_t input, bool on);
  /// The input stays so whatever a loopback does, until it is let go; then it follows its loopback again.
  bool hold_input(std::uint16_t input, bool on);
  void let_go_input(std::uint16_t input);
  bool set_analog_input(std::uint16_t input, std::uint16_t raw);
  bool input(std::uint16_t n) const noexcept { return n < inputs_.size() && inputs_[n]; }
  bool output(std::uint16_t n) const noexcept { return n < coils_.size() && coils_[n]; }
  std::uint16_t analog_input(std::uint16_t n) const noexcept {
    return n < analog_in_.size() ? analog_in_[n] : 0;
  }
  std::uint16_t analog_output(std::uint16_t n) const noexcept {
    return n < holding_.size() ? holding_[n] : 0;
  }
  std::uint64_t requests_served() const noexcept { return served_; }

 private:
  struct Wire {
    Loopback settings;
    bool pending = false;
    bool target = false;
    image::Nanoseconds due_ns = 0;
  };
  modbus::Response answer_to(const modbus::Request& request);
  bool input_register(std::size_t address, std::uint16_t& word) const noexcept;
  void follow(const Wire& wire);
  void lose_outputs();
  void lose_supply();
  void write_coil(std::uint16_t n, bool on, image::Nanoseconds t);
  void drive(Wire& wire, bool output, image::Nanoseconds t);

  std::optional<SimulatedInverter> inverter_;
  StationSettings settings_;
  std::vector<bool> inputs_, held_, coils_;
  std::vector<std::uint16_t> analog_in_, holding_;
  std::vector<Wire> wires_;
  bool has(fault::Kind kind) const noexcept { return fault_ && fault_->kind == kind; }
  void change_fault(const std::optional<fault::Fault>& fault);

  std::optional<fault::Fault> fault_;
  image::Nanoseconds now_ns_ = 0;
  image::Nanoseconds last_request_ns_ = 0;
  std::uint64_t served_ = 0;
};

}  // namespace servogate::mock
