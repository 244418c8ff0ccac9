// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "drivers/notice.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/points/point_rule.hpp"

namespace servogate::gpio {

/// A line of a chip that carries a point: its offset on the chip, as `gpioinfo` counts it.
struct Line {
  std::string name;  ///< of the point
  unsigned offset = 0;
  image::PointRule rule;
};

struct ChipConfig {
  std::string chip;         ///< its label, or its name (gpiochip0), or the path of its device
  std::string consumer;     ///< what other programs see as holder of the lines
  std::vector<Line> lines;  ///< inputs and outputs in any order, at most kMostLines of each
  int source = -1;          ///< index in image.sources; -1: none
};

/// Of one direction: what one system call of the kernel carries.
inline constexpr std::size_t kMostLines = 64;

/// A GPIO chip as a device of the cycle. In receive() the levels of all inputs are read by one system call,
/// so that an emergency stop or a limit switch acts in the cycle in which it is read; in send() all outputs
/// are written by one, when one of them has changed. A chip that does not answer any more (unplugged), for
/// reading or for writing, gives its inputs their values of loss, and its source is bad. At its end it writes
/// the values of loss and lets the lines go; what a line that nobody holds does then is the chip's affair.
class GpioChip final : public image::CycleDevice {
 public:
  /// Takes the lines; outputs begin at their values of loss. nullptr: `why` says what is wrong and what mends
  /// it. Not real-time safe.
  static std::unique_ptr<GpioChip> open(const ChipConfig& config, drivers::Notice& why);
  ~GpioChip() override;
  GpioChip(const GpioChip&) = delete;
  GpioChip& operator=(const GpioChip&) = delete;

  /// real-time safe but for the one system call.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// real-time safe but for the one system call.
  void send(image::ProcessImage& image) noexcept override;

 private:
  struct Lines;
  explicit GpioChip(std::unique_ptr<Lines> lines);

  std::unique_ptr<Lines> lines_;
};

}  // namespace servogate::gpio
