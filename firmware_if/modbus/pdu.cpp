// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/pdu.hpp"

#include "firmware_if/modbus/huanyang.hpp"

namespace servogate::modbus {

namespace {

constexpr std::uint16_t kCoilOn = 0xFF00, kCoilOff = 0x0000;
constexpr std::uint8_t kExceptionFlag = 0x80;

constexpr std::size_t packed(std::size_t bits) noexcept { return (bits + 7) / 8; }

std::uint16_t get_word(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

class Writer {
 public:
  explicit Writer(Pdu& pdu) noexcept : pdu_(pdu) { pdu_.size = 0; }
  void byte(std::size_t v) noexcept { pdu_.bytes[pdu_.size++] = static_cast<std::uint8_t>(v); }
  void word(std::uint16_t v) noexcept {
    byte(v >> 8);
    byte(v & 0xFF);
  }
  void bits(const Data& data, std::size_t count) noexcept {
    for (std::size_t i = 0; i < packed(count); ++i) {
      // Bits past the last one are sent as zero, as the specification asks.
      const std::size_t rest = count - 8 * i;
      byte(rest >= 8 ? data.bits[i] : data.bits[i] & ((1u << rest) - 1));
    }
  }
  void words(const Data& data, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i) word(data.words[i]);
  }

 private:
  Pdu& pdu_;
};

void read_bits(std::span<const std::uint8_t> bytes, std::size_t count, Data& data) noexcept {
  for (std::size_t i = 0; i < packed(count); ++i) data.bits[i] = bytes[i];
  if (count % 8 != 0) data.bits[count / 8] &= static_cast<std::uint8_t>((1u << (count % 8)) - 1);
}
void read_words(std::span<const std::uint8_t> bytes, std::size_t count, Data& data) noexcept {
  for (std::size_t i = 0; i < count; ++i) data.words[i] = get_word(bytes, 2 * i);
}

bool fits(Function f, std::uint32_t address, std::uint32_t count) noexcept {
  return count >= 1 && count <= max_count(f) && address + count <= 0x10000u;
}

Exception decode_single(std::span<const std::uint8_t> bytes, Request& out) noexcept {
  if (bytes.size() != 5) return Exception::illegal_data_value;
  const std::uint16_t v = get_word(bytes, 3);
  out.count = 1;
  if (out.function == Function::write_single_register) {
    out.data.words[0] = v;
    return Exception::none;
  }
  if (v != kCoilOn && v != kCoilOff) return Exception::illegal_data_value;
  out.data.set_bit(0, v == kCoilOn);
  return Exception::none;
}

Exception decode_multiple(std::span<const std::uint8_t> bytes, Request& out) noexcept {
  const bool bits = carries_bits(out.function);
  const std::size_t content = bits ? packed(out.count) : 2u * out.count;
  if (bytes.size() < 6 || bytes[5] != content || bytes.size() != 6 + content)
    return Exception::illegal_data_value;
  if (bits)
    read_bits(bytes.subspan(6), out.count, out.data);
  else
    read_words(bytes.subspan(6), out.count, out.data);
  return Exception::none;
}

}  // namespace

bool encode(const Request& r, Pdu& pdu) noexcept {
  if (r.coding == Coding::huanyang) return huanyang::encode(r, pdu);
  if (!fits(r.function, r.address, r.count)) return false;
  Writer w(pdu);
  w.byte(static_cast<std::uint8_t>(r.function));
  w.word(r.address);
  switch (r.function) {
    case Function::write_single_coil:
      w.word(r.data.bit(0) ? kCoilOn : kCoilOff);
      break;
    case Function::write_single_register:
      w.word(r.data.words[0]);
      break;
    case Function::write_multiple_coils:
      w.word(r.count);
      w.byte(packed(r.count));
      w.bits(r.data, r.count);
      break;
    case Function::write_multiple_registers:
      w.word(r.count);
      w.byte(2u * r.count);
      w.words(r.data, r.count);
      break;
    default:
      w.word(r.count);
  }
  return true;
}

Exception decode_request(std::span<const std::uint8_t> bytes, Request& out) noexcept {
  if (bytes.empty() || max_count(static_cast<Function>(bytes[0])) == 0) return Exception::illegal_function;
  if (bytes.size() < 5 || bytes.size() > kMaxPdu) return Exception::illegal_data_value;
  out.function = static_cast<Function>(bytes[0]);
  out.address = get_word(bytes, 1);
  if (out.function == Function::write_single_coil || out.function == Function::write_single_register)
    return decode_single(bytes, out);
  out.count = get_word(bytes, 3);
  if (out.count == 0 || out.count > max_count(out.function)) return Exception::illegal_data_value;
  if (writes(out.function)) {
    if (const Exception e = decode_multiple(bytes, out); e != Exception::none) return e;
  } else if (bytes.size() != 5) {
    return Exception::illegal_data_value;
  }
  return fits(out.function, out.address, out.count) ? Exception::none : Exception::illegal_data_address;
}

bool encode(const Response& r, Pdu& pdu) noexcept {
  if (r.exception != Exception::none) {
    Writer w(pdu);
    w.byte(static_cast<std::uint8_t>(r.function) | kExceptionFlag);
    w.byte(static_cast<std::uint8_t>(r.exception));
    return true;
  }
  if (!fits(r.function, r.address, r.count)) return false;
  Writer w(pdu);
  w.byte(static_cast<std::uint8_t>(r.function));
  if (writes(r.function)) {
    w.word(r.address);
    if (r.function == Function::write_single_coil)
      w.word(r.data.bit(0) ? kCoilOn : kCoilOff);
    else
      w.word(r.function == Function::write_single_register ? r.data.words[0] : r.count);
    return true;
  }
  if (carries_bits(r.function)) {
    w.byte(packed(r.count));
    w.bits(r.data, r.count);
  } else {
    w.byte(2u * r.count);
    w.words(r.data, r.count);
  }
  return true;
}

AnswerFault decode_response(std::span<const std::uint8_t> bytes, const Request& asked,
                            Response& out) noexcept {
  if (asked.coding == Coding::huanyang) return huanyang::decode_response(bytes, asked, out);
  if (bytes.size() < 2) return AnswerFault::too_short;
  out.function = asked.function;
  out.exception = Exception::none;
  out.address = asked.address;
  out.count = asked.count;
  const auto code = static_cast<std::uint8_t>(asked.function);
  if (bytes[0] == (code | kExceptionFlag)) {
    if (bytes.size() != 2 || bytes[1] == 0) return AnswerFault::wrong_length;
    out.exception = static_cast<Exception>(bytes[1]);
    return AnswerFault::none;
  }
  if (bytes[0] != code) return AnswerFault::wrong_function;
  if (bytes.size() != response_size(asked.function, asked.count)) return AnswerFault::wrong_length;
  if (writes(asked.function)) {
    Pdu echo;
    Response expected{asked.function, Exception::none, asked.address, asked.count, asked.data};
    encode(expected, echo);
    for (std::size_t i = 0; i < echo.size; ++i)
      if (echo.bytes[i] != bytes[i]) return AnswerFault::wrong_echo;
    return AnswerFault::none;
  }
  if (bytes[1] != bytes.size() - 2) return AnswerFault::wrong_length;
  if (carries_bits(asked.function))
    read_bits(bytes.subspan(2), asked.count, out.data);
  else
    read_words(bytes.subspan(2), asked.count, out.data);
  return AnswerFault::none;
}

std::size_t request_size(Function f, std::uint16_t count) noexcept {
  if (f == Function::write_multiple_coils) return 6 + packed(count);
  if (f == Function::write_multiple_registers) return 6 + 2u * count;
  return 5;
}

std::size_t response_size(Function f, std::uint16_t count) noexcept {
  if (writes(f)) return 5;
  return 2 + (carries_bits(f) ? packed(count) : 2u * count);
}

}  // namespace servogate::modbus
