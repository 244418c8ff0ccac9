// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {

/// Node-ID of a device that has none.
inline constexpr NodeId kUnconfiguredNode = 255;

/// The four numbers of 1018h that make a device unique.
struct LssIdentity {
  std::array<std::uint32_t, 4> part{};  ///< vendor-ID, product code, revision, serial number
  bool operator==(const LssIdentity&) const = default;
};

/// Command specifier in byte 0. Source: CiA 305, 3.9 "LSS protocol".
enum class LssCommand : std::uint8_t {
  switch_global = 0x04,
  configure_node = 0x11,
  configure_bit_timing = 0x13,
  activate_bit_timing = 0x15,
  store = 0x17,
  switch_vendor = 0x40,  ///< 40h-43h: one part each; the last one selects
  switch_serial = 0x43,
  switched = 0x44,
  identify_vendor = 0x46,  ///< 46h-4Bh: vendor, product, lowest and highest revision and serial number
  identify_serial_high = 0x4B,
  identify_unconfigured = 0x4C,
  identified = 0x4F,
  unconfigured = 0x50,
  fastscan = 0x51,
  inquire_vendor = 0x5A,  ///< 5Ah-5Dh: one part each
  inquire_serial = 0x5D,
  inquire_node = 0x5E,
};
enum class LssMode : std::uint8_t { waiting = 0, configuration = 1 };

/// Bit rates of the standard table by their index; 0: reserved. Source: CiA 305, table "Bit timing table".
inline constexpr std::array<std::uint32_t, 9> kLssBitRates{1'000'000, 800'000, 500'000, 250'000, 125'000,
                                                           0,         50'000,  20'000,  10'000};
/// Index of a bit rate, -1: not in the table. real-time safe.
constexpr int lss_bit_rate_index(std::uint32_t bit_s) noexcept {
  for (std::size_t i = 0; i < kLssBitRates.size(); ++i)
    if (bit_s != 0 && kLssBitRates[i] == bit_s) return static_cast<int>(i);
  return -1;
}

using LssBytes = std::array<std::uint8_t, 8>;
/// A command with a number behind it. real-time safe.
inline LssBytes lss_bytes(LssCommand command, std::uint32_t value = 0) noexcept {
  LssBytes bytes{static_cast<std::uint8_t>(command)};
  store_le(value, std::span(bytes).subspan(1, 4));
  return bytes;
}
inline std::uint32_t lss_value(const LssBytes& bytes) noexcept {
  return static_cast<std::uint32_t>(load_le(std::span(bytes).subspan(1, 4)));
}
/// The n-th of a run of commands. real-time safe.
constexpr LssCommand lss_nth(LssCommand first, int n) noexcept {
  return static_cast<LssCommand>(static_cast<int>(first) + n);
}

}  // namespace servogate::canopen
