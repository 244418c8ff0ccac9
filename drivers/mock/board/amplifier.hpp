// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/time.hpp"

namespace servogate::mock {

/// What is behind a channel of a simulated board.
struct AmplifierConfig {
  std::int64_t counts_per_rev = 4096;  ///< of the encoder
  std::int64_t steps_per_rev = 0;      ///< step: above 0; a stepper, or a servo with step input
  double pull_out = 0.0;               ///< step: rev/s beyond which steps are lost; 0: none
  double full_speed = 50.0;            ///< analog, PWM: rev/s at the full set-point
  double lag_s = 0.005;                ///< analog, PWM: time constant of the speed loop
  double drift = 0.0;                  ///< analog, PWM: of the full set-point, added by the amplifier
  bool reversed = false;               ///< a positive set-point lowers the counts
  double start = 0.0;                  ///< rev from machine zero at power-on; the encoder begins at 0
  double zero_mark = 0.0;              ///< rev from machine zero to the nearest index
};

/// A motor with its amplifier and encoder. Not real-time safe by promise, though it allocates nothing.
class Amplifier {
 public:
  explicit Amplifier(const AmplifierConfig& config) : config_(config), revolutions_(config.start) {}

  void set_enable(bool on) noexcept;
  void set_step(bool step, bool forward, image::Nanoseconds t) noexcept;
  /// -1 to 1.
  void set_value(double value) noexcept { value_ = value; }
  void advance(double dt) noexcept;
  /// From machine zero.
  double revolutions() const noexcept { return revolutions_; }
  std::int32_t counts() const noexcept;
  void arm_index(bool armed) noexcept {
    armed_ = armed;
    captured_ = false;
  }
  bool take_index(std::int32_t& counts) noexcept;
  bool enabled() const noexcept { return enabled_; }

  bool fault = false;       ///< its fault output reports
  /// Steps that were not followed.
  std::int64_t lost_steps() const noexcept { return lost_; }

 private:
  void turn_to(double revolutions) noexcept;
  std::int32_t counts_at(double revolutions) const noexcept;

  AmplifierConfig config_;
  double revolutions_;
  double speed_ = 0.0, value_ = 0.0;
  bool enabled_ = false, step_ = false, armed_ = false, captured_ = false;
  std::int32_t captured_counts_ = 0;
  std::int64_t steps_ = 0, lost_ = 0;
  image::Nanoseconds last_step_ns_ = -image::kSecond;
};

}  // namespace servogate::mock
