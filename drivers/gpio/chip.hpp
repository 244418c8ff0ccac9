// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/notice.hpp"
#include "firmware_if/image/time.hpp"

/// What drivers/gpio needs of the GPIO library, and the only place that knows which one it is: libgpiod 1.6
/// and, for what that lacks, the kernel's own interface (kernel_inputs.hpp). libgpiod 2 offers the same under
/// the same terms: one request of many lines with settings for each, one descriptor, events with numbers.
namespace servogate::gpio {

/// Of one direction: what one system call of the kernel carries.
inline constexpr std::size_t kMostLines = 64;

/// The resistor inside the chip. `as_is`: as the firmware of the board has left it.
enum class Bias : std::uint8_t { as_is, off, up, down };

struct InputSetting {
  std::string name;  ///< of the point, for messages
  unsigned offset = 0;
  Bias bias = Bias::as_is;
  bool edges = false;
};
struct OutputSetting {
  std::string name;
  unsigned offset = 0;
  bool level = false;  ///< at first
};

/// A line has changed.
struct LineEvent {
  std::size_t line = 0;         ///< in the order of the request
  bool level = false;           ///< after it, as on the wire
  image::Nanoseconds t_ns = 0;  ///< of the kernel's interrupt, CLOCK_MONOTONIC
  std::uint32_t number = 0;     ///< of the events of this line, from 1, those dropped by the kernel included
};

/// Inputs of one request. Bit n of a level word is the n-th line.
class InputLines {
 public:
  virtual ~InputLines() = default;
  /// All levels by one system call. false: the chip does not answer. real-time safe but for that call.
  virtual bool read(std::uint64_t& levels) noexcept = 0;
  /// Readable while events wait; -1: no line tells its edges.
  virtual int descriptor() const noexcept { return -1; }
  /// What waits, oldest first, without waiting for more. -1: the chip is gone. Of one thread, which need not
  /// be that of read().
  virtual int take(std::span<LineEvent>) noexcept { return 0; }
};

class OutputLines {
 public:
  virtual ~OutputLines() = default;
  /// All levels by one system call. false: the chip does not answer. real-time safe but for that call.
  virtual bool write(std::uint64_t levels) noexcept = 0;
};

/// A GPIO chip of this computer. Nothing of it is real-time safe but what it gives.
class Chip {
 public:
  /// By its label, its name (gpiochip0) or the path of its device. nullptr: `why` names the chips there are.
  static std::unique_ptr<Chip> find(const std::string& name, drivers::Notice& why);
  ~Chip();
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  /// Takes lines, under the name `consumer` for other programs. nullptr: `why` names the line that is not
  /// there or its holder. At most kMostLines.
  std::unique_ptr<InputLines> inputs(std::span<const InputSetting> lines, const std::string& consumer,
                                     drivers::Notice& why);
  std::unique_ptr<OutputLines> outputs(std::span<const OutputSetting> lines, const std::string& consumer,
                                       drivers::Notice& why);
  /// Whether the lines are there and nobody has them; takes none. False: `why` as above.
  bool free(std::span<const InputSetting> lines, drivers::Notice& why) const;
  bool free(std::span<const OutputSetting> lines, drivers::Notice& why) const;

 private:
  struct Impl;
  explicit Chip(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::gpio
