// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>

#include "drivers/gpio/chip.hpp"

namespace servogate::gpio {

/// Inputs by the kernel's interface of version 2 (linux/gpio.h, from Linux 5.10), for what libgpiod 1.6
/// cannot ask for. Its uses, each of them:
/// - GPIO_V2_GET_LINE_IOCTL: lines with different biases and with edges in one request, so that one system
///   call still reads them all; room for kEventRoom edges instead of 16;
/// - gpio_v2_line_event: the number of each edge, by which dropped ones are noticed;
/// - GPIO_V2_LINE_GET_VALUES_IOCTL: the levels of such a request.
class KernelInputs final : public InputLines {
 public:
  /// Edges that wait in the kernel; of more the oldest are dropped.
  static constexpr unsigned kEventRoom = 1024;

  /// `path` of the device of the chip. nullptr: errno says why. Not real-time safe.
  static std::unique_ptr<InputLines> request(const std::string& path, std::span<const InputSetting> lines,
                                             const std::string& consumer);
  ~KernelInputs() override;
  KernelInputs(const KernelInputs&) = delete;
  KernelInputs& operator=(const KernelInputs&) = delete;

  bool read(std::uint64_t& levels) noexcept override;
  int descriptor() const noexcept override { return edges_ ? descriptor_ : -1; }
  int take(std::span<LineEvent> events) noexcept override;

 private:
  KernelInputs(int descriptor, std::span<const InputSetting> lines);
  std::size_t line_of(unsigned offset) const noexcept;

  int descriptor_;
  bool edges_ = false;
  std::uint64_t mask_ = 0;
  std::size_t count_ = 0;
  std::array<unsigned, kMostLines> offsets_{};
};

}  // namespace servogate::gpio
