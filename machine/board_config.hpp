// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

namespace servogate::machine {

/// What a channel of a board puts out to an amplifier, and where the position of its axis comes from.
enum class BoardOutput : std::uint8_t { step, analog, pwm };
enum class BoardFeedback : std::uint8_t { encoder, steps };

/// [axis.board]: the amplifier of an axis on a channel of a USB board instead of a drive on a bus.
struct BoardChannelConfig {
  std::string station;  ///< of kind board
  int channel = 0;      ///< 0-3: its outputs, encoder, enable and fault lines
  BoardOutput output = BoardOutput::step;
  BoardFeedback feedback = BoardFeedback::encoder;
  std::int64_t steps_per_rev = 0;  ///< step: of the motor
  double step_time = 5e-6;         ///< s, step: shortest time of a level
  double full_speed = 0.0;  ///< rpm of the motor at the full set-point (10 V, 100 per cent), analog and pwm
  double position_gain = 0.0;  ///< 1/s, analog and pwm: of the position loop in the control
  double offset = 0.0;         ///< per cent of the full set-point, analog and pwm
  bool reversed = false;       ///< a positive set-point lowers the counts
  bool fault_low = false;      ///< the fault line reports at level 0
  bool present() const { return !station.empty(); }
};

}  // namespace servogate::machine
