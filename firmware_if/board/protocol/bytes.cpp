// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/protocol/bytes.hpp"

namespace servogate::board {

namespace {

constexpr std::size_t kPacket = 64;  ///< of a full-speed bulk pipe; a divisor of that of high speed

/// Little-endian, byte by byte: no alignment, whatever the processor.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> buffer) : buffer_(buffer) {}
  static constexpr bool kReads = false;

  template <class T>
  void number(const T& value) noexcept {
    auto bits = static_cast<std::uint32_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8)
      if (at_ < buffer_.size()) buffer_[at_++] = static_cast<std::uint8_t>(bits & 0xFFu);
  }
  template <class E>
  void choice(const E& value, E) noexcept {
    number(static_cast<std::uint8_t>(value));
  }
  void flag(const bool& value) noexcept { number(static_cast<std::uint8_t>(value ? 1 : 0)); }
  std::size_t size() const noexcept { return at_; }

 private:
  std::span<std::uint8_t> buffer_;
  std::size_t at_ = kHeaderBytes;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> body) : body_(body) {}
  static constexpr bool kReads = true;

  template <class T>
  void number(T& value) noexcept {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      if (at_ < body_.size())
        bits |= static_cast<std::uint32_t>(body_[at_++]) << (8 * i);
      else
        good_ = false;
    value = static_cast<T>(bits);
  }
  template <class E>
  void choice(E& value, E last) noexcept {
    std::uint8_t number_of = 0;
    number(number_of);
    if (number_of > static_cast<std::uint8_t>(last)) good_ = false;
    value = good_ ? static_cast<E>(number_of) : E{};
  }
  void flag(bool& value) noexcept {
    std::uint8_t byte = 0;
    number(byte);
    if (byte > 1) good_ = false;
    value = byte != 0;
  }
  bool good() const noexcept { return good_ && at_ == body_.size(); }
  void bad() noexcept { good_ = false; }

 private:
  std::span<const std::uint8_t> body_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// One list of the members of each message, for both directions. `Body` is const where they are written.
template <class Bytes, class Array>
void numbers(Bytes& bytes, Array& array) noexcept {
  for (auto& value : array) bytes.number(value);
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Description&) noexcept {
  b.number(m.protocol);
  b.number(m.firmware);
  b.number(m.inputs);
  b.number(m.outputs);
  b.number(m.analog_inputs);
  b.number(m.analog_outputs);
  numbers(b, m.capabilities);
  b.number(m.max_step_rate);
  b.number(m.full_scale_mv);
  numbers(b, m.serial);
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Configuration&) noexcept {
  b.number(m.period_us);
  b.number(m.watchdog_us);
  b.number(m.safe_outputs);
  b.number(m.edge_mask);
  numbers(b, m.safe_analog);
  for (auto& c : m.channels) {
    b.choice(c.output, Output::pwm);
    b.flag(c.fault_is_low);
    b.number(c.step_us);
    b.number(c.stop_rate);
    b.number(c.pwm_hz);
  }
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Configured&) noexcept {
  b.choice(m.result, ConfigureResult::no_such_output);
  b.number(m.channel);
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Command&) noexcept {
  b.number(m.outputs);
  b.number(m.enable);
  b.number(m.latch);
  b.number(m.flags);
  numbers(b, m.analog);
  for (auto& c : m.channels) {
    b.number(c.target);
    b.number(c.rate);
  }
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Status&) noexcept {
  b.number(m.t_us);
  b.number(m.inputs);
  b.number(m.flags);
  b.number(m.faults);
  b.number(m.enabled);
  b.number(m.limited);
  b.number(m.lost_edges);
  b.number(m.trips);
  numbers(b, m.analog);
  for (auto& c : m.channels) {
    b.number(c.counts);
    b.number(c.steps);
    b.number(c.latched);
    b.number(c.latches);
  }
  b.number(m.edge_count);
  if (m.edge_count > kEdges) {
    if constexpr (Bytes::kReads) b.bad();
    return;
  }
  for (std::size_t n = 0; n < m.edge_count; ++n) {
    b.number(m.edges[n].input);
    b.flag(m.edges[n].level);
    b.number(m.edges[n].t_us);
  }
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Injection&) noexcept {
  b.choice(m.fault, Fault::drive_fault);
  b.number(m.number);
  b.number(m.value);
}

template <class Bytes, class Body>
void members(Bytes& b, Body& m, const Refusal&) noexcept {
  b.number(m.kind);
  b.choice(m.reason, Reason::not_configured);
}

std::size_t finish(Header header, std::span<std::uint8_t> buffer, std::size_t size) noexcept {
  buffer[0] = kMark;
  buffer[1] = static_cast<std::uint8_t>(header.kind);
  buffer[2] = static_cast<std::uint8_t>(size & 0xFFu);
  buffer[3] = static_cast<std::uint8_t>(size >> 8);
  for (std::size_t i = 0; i < 4; ++i)
    buffer[4 + i] = static_cast<std::uint8_t>(header.sequence >> (8 * i) & 0xFFu);
  if (size % kPacket == 0 && size < buffer.size()) buffer[size++] = 0;
  return size;
}

template <class Body>
std::size_t put_body(Header header, const Body& body, std::span<std::uint8_t> buffer) noexcept {
  if (buffer.size() < kMostBytes) return 0;
  Writer writer(buffer);
  members(writer, body, body);
  return finish(header, buffer, writer.size());
}

template <class Body>
bool take_body(std::span<const std::uint8_t> bytes, Body& to) noexcept {
  Reader reader(bytes);
  members(reader, to, to);
  return reader.good();
}

}  // namespace

bool parse(std::span<const std::uint8_t> bytes, Message& message) noexcept {
  if (bytes.size() < kHeaderBytes || bytes[0] != kMark) return false;
  const auto length = static_cast<std::size_t>(bytes[2] | bytes[3] << 8);
  const bool padded = length % kPacket == 0;
  if (length < kHeaderBytes || bytes.size() != length + (padded ? 1 : 0)) return false;
  message.header.kind = static_cast<Kind>(bytes[1]);
  message.header.sequence = 0;
  for (std::size_t i = 0; i < 4; ++i)
    message.header.sequence |= static_cast<std::uint32_t>(bytes[4 + i]) << (8 * i);
  message.body = bytes.subspan(kHeaderBytes, length - kHeaderBytes);
  return true;
}

std::size_t put(Header header, std::span<std::uint8_t> buffer) noexcept {
  return buffer.size() < kMostBytes ? 0 : finish(header, buffer, kHeaderBytes);
}
std::size_t put(Header h, const Description& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Configuration& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Configured& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Command& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Status& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Injection& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}
std::size_t put(Header h, const Refusal& body, std::span<std::uint8_t> buffer) noexcept {
  return put_body(h, body, buffer);
}

bool take(std::span<const std::uint8_t> body, Description& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Configuration& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Configured& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Command& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Status& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Injection& to) noexcept { return take_body(body, to); }
bool take(std::span<const std::uint8_t> body, Refusal& to) noexcept { return take_body(body, to); }

}  // namespace servogate::board
