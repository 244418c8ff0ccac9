// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/image/process_image.hpp"

namespace servogate::axis {

/// An inverter behind an analog output and relays, as plain data from the machine file.
struct InverterConfig {
  image::Place speed;  ///< word of packet A: rpm without sign
  std::optional<image::Place>
      cw;  ///< relay bits; without them the inverter turns clockwise by the speed alone
  std::optional<image::Place> ccw;  ///< without it there is no counter-clockwise
  std::uint32_t sources = 0;        ///< bit n: image.sources[n] carries one of the outputs
};

/// A spindle without feedback: an inverter that takes its speed as a voltage and its direction from two
/// relays. The relays exclude each other and change only at a commanded standstill, with a pause between
/// them. What the spindle really does is not known; `assumed_rpm` follows the command on the ramp, also after
/// everything has been switched off at once. Everything real-time safe.
class Inverter {
 public:
  void configure(const InverterConfig& config) noexcept;
  /// A way to turn counter-clockwise exists.
  bool reverses() const noexcept { return config_.ccw.has_value(); }
  /// One of its stations does not answer.
  bool lost(const image::ProcessImage& image) const noexcept;
  /// One cycle towards `wanted_rpm` (+ clockwise), by at most `step_rpm`. `cut`: speed 0 and both relays off
  /// now.
  void advance(double wanted_rpm, double step_rpm, bool cut, double dt) noexcept;
  /// Speed, times `ratio` of the gear in force, and relays into packet A.
  void write(image::ProcessImage& image, double ratio) const noexcept;
  double command_rpm() const noexcept { return command_; }
  double assumed_rpm() const noexcept { return assumed_; }

 private:
  InverterConfig config_;
  double command_ = 0.0;
  double assumed_ = 0.0;
  int direction_ = 0;     ///< of the relay that is on
  double pause_s_ = 0.0;  ///< both relays stay off so long
};

}  // namespace servogate::axis
