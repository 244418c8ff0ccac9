// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace servogate::modbus {

/// Functions spoken here. Source: Modbus Application Protocol V1.1b3, section 6.
enum class Function : std::uint8_t {
  read_coils = 1,
  read_discrete_inputs = 2,
  read_holding_registers = 3,
  read_input_registers = 4,
  write_single_coil = 5,
  write_single_register = 6,
  write_multiple_coils = 15,
  write_multiple_registers = 16,
};

/// Exception codes. Source: the same, section 7.
enum class Exception : std::uint8_t {
  none = 0,
  illegal_function = 1,
  illegal_data_address = 2,
  illegal_data_value = 3,
  server_device_failure = 4,
  acknowledge = 5,
  server_device_busy = 6,
  memory_parity_error = 8,
  gateway_path_unavailable = 10,
  gateway_target_failed = 11,
};

/// How a request stands on the wire.
enum class Coding : std::uint8_t {
  standard,
  huanyang,  ///< functions of its own, huanyang.hpp
};

inline constexpr std::size_t kMaxPdu = 253;  ///< bytes; V1.1b3, section 4.1
inline constexpr std::uint16_t kMaxReadBits = 2000, kMaxReadWords = 125;
inline constexpr std::uint16_t kMaxWriteBits = 1968, kMaxWriteWords = 123;

/// True for functions 1, 2, 5, 15, whose data are bits. real-time safe.
constexpr bool carries_bits(Function f) noexcept {
  return f == Function::read_coils || f == Function::read_discrete_inputs ||
         f == Function::write_single_coil || f == Function::write_multiple_coils;
}
/// True for functions 5, 6, 15, 16. real-time safe.
constexpr bool writes(Function f) noexcept { return static_cast<std::uint8_t>(f) >= 5; }
/// Largest count that one request of this function may carry (1 for 5 and 6; 0 when it is none of ours).
/// real-time safe.
constexpr std::uint16_t max_count(Function f) noexcept {
  switch (f) {
    case Function::read_coils:
    case Function::read_discrete_inputs:
      return kMaxReadBits;
    case Function::read_holding_registers:
    case Function::read_input_registers:
      return kMaxReadWords;
    case Function::write_single_coil:
    case Function::write_single_register:
      return 1;
    case Function::write_multiple_coils:
      return kMaxWriteBits;
    case Function::write_multiple_registers:
      return kMaxWriteWords;
  }
  return 0;
}

/// Bits or words of one request or response, by value.
struct Data {
  std::array<std::uint8_t, kMaxReadBits / 8> bits{};  ///< packed, first in bit 0 of byte 0
  std::array<std::uint16_t, kMaxReadWords> words{};

  bool bit(std::size_t n) const noexcept { return ((bits[n / 8] >> (n % 8)) & 1u) != 0; }
  void set_bit(std::size_t n, bool value) noexcept {
    const auto mask = static_cast<std::uint8_t>(1u << (n % 8));
    bits[n / 8] = static_cast<std::uint8_t>(value ? bits[n / 8] | mask : bits[n / 8] & ~mask);
  }
};

/// What a client asks. `data` counts for the writing functions only.
struct Request {
  Function function = Function::read_coils;
  std::uint16_t address = 0;  ///< as on the wire, from 0
  std::uint16_t count = 1;
  Data data;
  Coding coding = Coding::standard;
};

/// What a server answers: an exception, or the data read; a write echoes address and count.
struct Response {
  Function function = Function::read_coils;
  Exception exception = Exception::none;
  std::uint16_t address = 0;
  std::uint16_t count = 1;
  Data data;
};

/// A protocol data unit: function code and data, without unit address and checksum.
struct Pdu {
  std::array<std::uint8_t, kMaxPdu> bytes{};
  std::size_t size = 0;

  std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), size}; }
};

/// What is wrong with an answer, as the client sees it.
enum class AnswerFault : std::uint8_t {
  none,
  too_short,
  wrong_function,  ///< not the function that was asked
  wrong_length,    ///< byte count and length do not agree with the request
  wrong_echo,      ///< a write was answered with another address, count or value
};

/// Request to bytes. False (and nothing written) when count is 0, above the function's maximum, or runs past
/// address 65535. real-time safe.
bool encode(const Request& request, Pdu& pdu) noexcept;
/// Bytes to request, as a server takes them. none: well formed; else the exception to answer with. real-time
/// safe.
Exception decode_request(std::span<const std::uint8_t> bytes, Request& request) noexcept;

/// Response to bytes. real-time safe.
bool encode(const Response& response, Pdu& pdu) noexcept;
/// Bytes to response, checked against the request that they answer; an exception answer is well formed and
/// fills `response.exception`. real-time safe.
AnswerFault decode_response(std::span<const std::uint8_t> bytes, const Request& asked,
                            Response& response) noexcept;

/// Bytes of the PDU that asks, and of the PDU that answers without exception: what line time is computed
/// from. real-time safe.
std::size_t request_size(Function function, std::uint16_t count) noexcept;
std::size_t response_size(Function function, std::uint16_t count) noexcept;

}  // namespace servogate::modbus
