// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/gpio/chip.hpp"
#include "drivers/notice.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/points/point_rule.hpp"

namespace servogate::gpio {

/// A point on a line of a chip, by its offset as `gpioinfo` counts it. A digital input or output; or, with
/// `b_offset`, an encoder of two tracks whose counts are an analog input: a handwheel. Its rule holds its
/// value while the chip is lost: a jump of the counts would be a motion.
struct Line {
  std::string name;  ///< of the point
  unsigned offset = 0;
  image::PointRule rule;
  Bias bias = Bias::as_is;             ///< inputs
  bool edges = false;                  ///< digital input: each edge with the kernel's time, beside the level
  std::optional<unsigned> b_offset{};  ///< line of track B; `offset` is that of track A
};

struct ChipConfig {
  std::string chip;         ///< its label, or its name (gpiochip0), or the path of its device
  std::string consumer;     ///< what other programs see as holder of the lines
  std::vector<Line> lines;  ///< inputs and outputs in any order, at most kMostLines of each
  int source = -1;          ///< index in image.sources; -1: none
};

/// Since the start.
struct ChipCounters {
  std::uint64_t edges = 0;           ///< that the kernel has given
  std::uint32_t lost = 0;            ///< edges known to be missing
  std::uint32_t encoder_errors = 0;  ///< transitions that no turning encoder makes
};

/// A GPIO chip as a device of the cycle. In receive() the levels of all inputs are read by one system call,
/// so that an emergency stop or a limit switch acts in the cycle in which it is read; in send() all outputs
/// are written by one, when one of them has changed. Edges and encoders come from a thread (edge_thread.hpp):
/// an edge stands in ProcessImage::edges in the cycle of its level or a little later, with the time of its
/// interrupt, not debounced; a lost one is counted there and as an error of the source. A chip that does not
/// answer any more (unplugged), for reading or for writing, gives its inputs their values of loss (an encoder
/// keeps its counts), and its source is bad. At its end it writes the values of loss and lets the lines go;
/// what a line that nobody holds does then is the chip's affair.
class GpioChip final : public image::CycleDevice {
 public:
  /// Takes the lines; outputs begin at their values of loss. nullptr: `why` says what is wrong and what mends
  /// it. Not real-time safe.
  static std::unique_ptr<GpioChip> open(const ChipConfig& config, drivers::Notice& why);
  /// Whether open() would find the chip and its lines free; takes none. Not real-time safe.
  static bool available(const ChipConfig& config, drivers::Notice& why);
  ~GpioChip() override;
  GpioChip(const GpioChip&) = delete;
  GpioChip& operator=(const GpioChip&) = delete;

  /// real-time safe.
  void open_cycle(image::ProcessImage& image) noexcept override;
  /// real-time safe but for the one system call.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// real-time safe but for the one system call.
  void send(image::ProcessImage& image) noexcept override;

  /// real-time safe.
  ChipCounters counters() const noexcept;

 private:
  struct Parts;
  explicit GpioChip(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace servogate::gpio
