// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "drivers/modbus/line_address.hpp"
#include "drivers/notice.hpp"
#include "drivers/waker.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/modbus/line_counters.hpp"
#include "firmware_if/modbus/pdu.hpp"

struct _modbus;

namespace servogate::modbus {

enum class Parity : char { none = 'N', even = 'E', odd = 'O' };

/// A serial device with eight data bits.
struct SerialPort {
  std::string device;  ///< "/dev/ttyUSB0"
  std::uint32_t baud = 19'200;
  Parity parity = Parity::even;
  int stop_bits = 1;
};

struct LinkSettings {
  std::variant<TcpAddress, SerialPort> peer;
  /// From the end of a request to the beginning of its answer; what the wire takes comes on top.
  image::Nanoseconds answer_timeout_ns = 100 * image::kMillisecond;
};

/// The connection of a master to its line: libmodbus opens it, frames requests and reads answers, and does
/// nothing by itself: no repeats, no reconnecting. Of one thread; not real-time safe.
class Link {
 public:
  explicit Link(LinkSettings settings);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  bool serial() const noexcept { return std::holds_alternative<SerialPort>(settings_.peer); }
  std::uint32_t baud() const noexcept;  ///< 0: no line time
  bool is_open() const noexcept { return modbus_ != nullptr; }
  /// False: refused, `why` says what is wrong and what mends it. Waits for a TCP peer a second at most.
  bool open(drivers::Notice& why);
  /// Throws away what is under way and closes.
  void close() noexcept;

  /// One request of an open link and its answer. `waker` gives up the wait when it has ended; nullptr: nobody
  /// does.
  Heard exchange(std::uint8_t unit, const Request& request, Response& response, drivers::Waker* waker);

 private:
  struct Free {
    void operator()(_modbus* m) const noexcept;
  };
  bool ask(std::uint8_t unit, const Pdu& pdu);
  /// Readable by `deadline`.
  Heard await(image::Nanoseconds deadline, drivers::Waker* waker);
  Heard read(std::uint8_t unit, const Request& request, image::Nanoseconds deadline, Response& response);
  /// The answer to a request that is none of the standard.
  Heard read_own(std::uint8_t unit, const Request& request, image::Nanoseconds deadline, Response& response);
  bool open_serial(const SerialPort& port, drivers::Notice& why);
  bool open_tcp(const TcpAddress& peer, drivers::Notice& why);

  LinkSettings settings_;
  std::unique_ptr<_modbus, Free> modbus_;
  std::uint16_t transaction_ = 0;
};

}  // namespace servogate::modbus
