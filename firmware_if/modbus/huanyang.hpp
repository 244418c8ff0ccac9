// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "firmware_if/modbus/pdu.hpp"

/// The requests of Huanyang inverters: frames and checksum of Modbus RTU, functions of their own with a count
/// of bytes behind each. They stand here for the registers that a poller knows:
///
/// | request                       | on the wire                          |
/// |-------------------------------|--------------------------------------|
/// | holding register n            | 01 03 n 00 00, parameter PDn         |
/// | input register n              | 04 03 n 00 00, value n of the status |
/// | write register kControl       | 03 01 command                        |
/// | write register kFrequency     | 05 02 high low, hundredths of a Hz   |
///
/// The answer to a command carries the control status, which is given as the data of the answer. Values of
/// the status: 0 set and 1 output frequency in 0.01 Hz, 2 current in 0.1 A, 3 rpm. Source: manual of the HY
/// series, communication parameters PD163 to PD165, as drivers in the field speak it.
namespace servogate::modbus::huanyang {

inline constexpr std::uint16_t kControl = 3, kFrequency = 5;
/// Bytes of the longest frame behind its station address.
inline constexpr std::size_t kLongest = 6;

/// False (and nothing written): no such request exists. real-time safe.
bool encode(const Request& request, Pdu& pdu) noexcept;
/// Bytes to request, as the inverter takes them. none: well formed. real-time safe.
Exception decode_request(std::span<const std::uint8_t> bytes, Request& request) noexcept;
/// What the inverter answers. real-time safe.
bool encode(const Response& response, Pdu& pdu) noexcept;
/// Bytes to response, checked against the request that they answer. real-time safe.
AnswerFault decode_response(std::span<const std::uint8_t> bytes, const Request& asked,
                            Response& response) noexcept;

}  // namespace servogate::modbus::huanyang
