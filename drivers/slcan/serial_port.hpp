// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/notice.hpp"

namespace servogate::slcan {

/// "PATH" or "PATH@BAUD" of a url.
struct SerialPlace {
  std::string path;
  std::uint32_t baud = 115'200;  ///< an adapter that is a USB device itself takes any
};
/// nullopt: no path, or no baud rate that a serial port of Linux has.
std::optional<SerialPlace> parse_place(std::string_view text);

/// A serial port in raw mode, of one program at a time. Not real-time safe but where it says so.
class SerialPort {
 public:
  /// nullopt: `why` says what is wrong.
  static std::optional<SerialPort> open(const SerialPlace& place, drivers::Notice& why);
  SerialPort(SerialPort&& other) noexcept;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort();

  int descriptor() const noexcept { return descriptor_; }
  /// Never waits; how many bytes went, 0: none now, -1: the port has gone. real-time safe.
  int write(std::string_view bytes) noexcept;
  int read(char* bytes, std::size_t size) noexcept;

 private:
  explicit SerialPort(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace servogate::slcan
