// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/clock.hpp"
#include "drivers/modbus/modbus_line.hpp"
#include "tests/modbus_line/rig/units.hpp"

namespace servogate::modbus_line {

/// Time for an answer within which one comes on any computer, and one in which none need come.
inline constexpr image::Nanoseconds kLong = 60 * image::kSecond, kShort = 30 * image::kMillisecond;

/// Sixteen inputs, sixteen coils, four input registers and two holding registers for each unit, the n-th unit
/// as source n, as far as there are sources. Input i of unit n is at bit 32 n + i of packet A, coil i at
/// 32 n + 16 + i, its registers at the words behind byte 256 + 12 n: four inputs, two outputs. Coil 15 holds
/// its value at a loss.
modbus::Map map_of(const std::vector<std::uint8_t>& units,
                   image::Nanoseconds period = 5 * image::kMillisecond);
modbus::LineSettings tcp(const Units& units, image::Nanoseconds timeout = kLong);
modbus::LineSettings rtu(const std::string& device, image::Nanoseconds timeout = kLong);

/// A line with a cycle around it, a millisecond each, in the computer's time.
class Cycles {
 public:
  Cycles(const modbus::LineSettings& settings, const std::vector<std::uint8_t>& units,
         image::Nanoseconds period = 5 * image::kMillisecond);
  ~Cycles();

  /// Cycles until it is so; false: it never was.
  bool until(const std::function<bool()>& met);
  void step();
  /// The control ends.
  void end() { line_.reset(); }

  modbus::ModbusLine& line() { return *line_; }
  modbus::LineCounters counters() const { return line_->counters(); }
  image::ProcessImage& image() { return *image_; }
  image::Quality quality(std::size_t unit) const { return image_->sources[unit].quality; }
  bool good(std::size_t unit) const { return quality(unit) == image::Quality::good; }
  bool input(std::size_t unit, int n) const;
  double analog(std::size_t unit, int n) const;
  void set_coil(std::size_t unit, int n, bool on);
  void set_analog(std::size_t unit, int n, double value);
  /// Called behind every cycle.
  std::function<void()> watch;

 private:
  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
  image::Notices notices_;
  std::unique_ptr<modbus::ModbusLine> line_;
};

}  // namespace servogate::modbus_line
