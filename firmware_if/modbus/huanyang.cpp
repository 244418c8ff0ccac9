// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/huanyang.hpp"

#include <initializer_list>

namespace servogate::modbus::huanyang {

namespace {

constexpr std::uint8_t kReadParameter = 1, kWriteControl = 3, kReadStatus = 4, kWriteFrequency = 5;
constexpr std::uint8_t kExceptionFlag = 0x80;
constexpr std::uint16_t kStatusValues = 8, kParameters = 256;

void put(Pdu& pdu, std::initializer_list<unsigned> bytes) noexcept {
  pdu.size = 0;
  for (const unsigned b : bytes) pdu.bytes[pdu.size++] = static_cast<std::uint8_t>(b);
}

/// The function of a request; 0: there is none.
std::uint8_t function_of(Function f, std::uint16_t address, std::uint16_t count) noexcept {
  if (count != 1) return 0;
  if (f == Function::read_holding_registers && address < kParameters) return kReadParameter;
  if (f == Function::read_input_registers && address < kStatusValues) return kReadStatus;
  if (f != Function::write_single_register) return 0;
  return address == kControl ? kWriteControl : address == kFrequency ? kWriteFrequency : 0;
}

}  // namespace

bool encode(const Request& r, Pdu& pdu) noexcept {
  const unsigned value = r.data.words[0];
  switch (function_of(r.function, r.address, r.count)) {
    case kReadParameter:
      put(pdu, {kReadParameter, 3, r.address, 0, 0});
      return true;
    case kReadStatus:
      put(pdu, {kReadStatus, 3, r.address, 0, 0});
      return true;
    case kWriteControl:
      put(pdu, {kWriteControl, 1, value & 0xFF});
      return true;
    case kWriteFrequency:
      put(pdu, {kWriteFrequency, 2, value >> 8, value & 0xFF});
      return true;
    default:
      return false;
  }
}

Exception decode_request(std::span<const std::uint8_t> bytes, Request& r) noexcept {
  if (bytes.size() < 3 || bytes.size() != 2u + bytes[1]) return Exception::illegal_data_value;
  r.coding = Coding::huanyang;
  r.count = 1;
  const std::uint8_t length = bytes[1];
  switch (bytes[0]) {
    case kReadParameter:
    case kReadStatus:
      r.function =
          bytes[0] == kReadStatus ? Function::read_input_registers : Function::read_holding_registers;
      r.address = bytes[2];
      return bytes[0] == kReadStatus && r.address >= kStatusValues ? Exception::illegal_data_address
                                                                   : Exception::none;
    case kWriteControl:
    case kWriteFrequency: {
      const bool frequency = bytes[0] == kWriteFrequency;
      if (length != (frequency ? 2 : 1)) return Exception::illegal_data_value;
      r.function = Function::write_single_register;
      r.address = frequency ? kFrequency : kControl;
      r.data.words[0] = static_cast<std::uint16_t>(frequency ? bytes[2] << 8 | bytes[3] : bytes[2]);
      return Exception::none;
    }
    default:
      return Exception::illegal_function;
  }
}

bool encode(const Response& r, Pdu& pdu) noexcept {
  const std::uint8_t function = function_of(r.function, r.address, r.count);
  const unsigned value = r.data.words[0];
  if (function == 0) return false;
  if (r.exception != Exception::none) {
    put(pdu, {unsigned{function} | kExceptionFlag, static_cast<unsigned>(r.exception)});
    return true;
  }
  if (function == kWriteControl)
    put(pdu, {function, 1, value & 0xFF});
  else if (function == kWriteFrequency)
    put(pdu, {function, 2, value >> 8, value & 0xFF});
  else
    put(pdu, {function, 3, r.address, value >> 8, value & 0xFF});
  return true;
}

AnswerFault decode_response(std::span<const std::uint8_t> bytes, const Request& asked, Response& r) noexcept {
  if (bytes.size() < 2) return AnswerFault::too_short;
  const std::uint8_t function = function_of(asked.function, asked.address, asked.count);
  r = {asked.function, Exception::none, asked.address, asked.count, {}};
  if (bytes[0] == (function | kExceptionFlag)) {
    r.exception = static_cast<Exception>(bytes[1]);
    return r.exception == Exception::none ? AnswerFault::wrong_length : AnswerFault::none;
  }
  if (bytes[0] != function) return AnswerFault::wrong_function;
  if (bytes.size() != 2u + bytes[1]) return AnswerFault::wrong_length;
  const std::span<const std::uint8_t> data = bytes.subspan(2);
  if (function == kWriteControl) {
    if (data.size() != 1) return AnswerFault::wrong_length;
    r.data.words[0] = data[0];
    return AnswerFault::none;
  }
  if (function == kWriteFrequency) {
    if (data.size() != 2) return AnswerFault::wrong_length;
    r.data.words[0] = static_cast<std::uint16_t>(data[0] << 8 | data[1]);
    return r.data.words[0] == asked.data.words[0] ? AnswerFault::none : AnswerFault::wrong_echo;
  }
  // Some parameters are one byte long.
  if (data.size() < 2 || data.size() > 3) return AnswerFault::wrong_length;
  if (data[0] != asked.address) return AnswerFault::wrong_echo;
  r.data.words[0] = static_cast<std::uint16_t>(data.size() == 3 ? data[1] << 8 | data[2] : data[1]);
  return AnswerFault::none;
}

}  // namespace servogate::modbus::huanyang
