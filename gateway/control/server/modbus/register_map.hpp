// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/modbus/pdu.hpp"

/// What stands at which address of the Modbus server; docs/modbus-server.md is its table.
namespace servogate::gateway {

/// First addresses. Bits (functions 1, 2, 5, 15) and words (3, 4, 6, 16) have address spaces of their own.
struct RegisterMap {
  static constexpr std::uint32_t kBitsOfA = 0, kBitsOfK = 10'000;
  static constexpr std::uint32_t kWordsOfA = 0, kWordsOfK = 2'000;
  static constexpr std::uint32_t kAxes = 20'000, kAxisWords = 20;
  static constexpr std::uint32_t kSpindles = 21'000, kSpindleWords = 10;
  static constexpr std::uint32_t kMachine = 22'000, kMachineWords = 8;
};

/// What a snapshot shows beside the image.
struct SeenAlarms {
  int count = 0;
  std::uint16_t first = 0;  ///< number of the first fault; 0: none
};

/// Answers a read from the image of a whole cycle; illegal_data_address where one of its items does not
/// exist.
modbus::Response read_registers(const modbus::Request& asked, const image::ProcessImage& image,
                                const SeenAlarms& alarms);

/// Bytes of packet K, first to last.
struct ByteRange {
  std::uint32_t first = 0, last = 0;
};
/// "SK200", "SK200-SK231"; nullopt: it is no range of packet K.
std::optional<ByteRange> parse_range(std::string_view text);

/// A place and what is to be written into it.
struct PlaceWrite {
  std::string place;  ///< "SK100.IN"
  double value = 0.0;
};
/// The places that a write means; nullopt: one of them is not in packet K or not in an open range.
std::optional<std::vector<PlaceWrite>> places_of(const modbus::Request& asked,
                                                 std::span<const ByteRange> open);

}  // namespace servogate::gateway
