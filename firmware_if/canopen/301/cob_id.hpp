// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::canopen {

/// CANopen node-ID, 1-127; 0 means "all nodes" in NMT commands and "no node" elsewhere.
using NodeId = std::uint8_t;
inline constexpr NodeId kMaxNode = 127;

/// CAN identifiers of the pre-defined connection set. Source: CiA 301, 7.3.5 "Pre-defined connection set".
namespace cob {
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kTime = 0x100;
constexpr std::uint32_t emcy(NodeId node) noexcept { return 0x080u + node; }
/// number 1-4. TPDO: the device transmits; RPDO: the device receives.
constexpr std::uint32_t tpdo(int number, NodeId node) noexcept {
  return 0x080u + 0x100u * static_cast<unsigned>(number) + node;
}
constexpr std::uint32_t rpdo(int number, NodeId node) noexcept {
  return 0x100u + 0x100u * static_cast<unsigned>(number) + node;
}
/// Answers of the SDO server (device to client) and requests to it (client to device).
constexpr std::uint32_t sdo_response(NodeId node) noexcept { return 0x580u + node; }
constexpr std::uint32_t sdo_request(NodeId node) noexcept { return 0x600u + node; }
/// Heartbeat, boot-up and node guarding share one identifier.
constexpr std::uint32_t heartbeat(NodeId node) noexcept { return 0x700u + node; }
inline constexpr std::uint32_t kLssSlave = 0x7E4;
inline constexpr std::uint32_t kLssMaster = 0x7E5;
/// Bit 31 of a PDO's COB-ID entry (1400h/1800h:01): the PDO does not exist; bit 30: no remote request
/// allowed.
inline constexpr std::uint32_t kInvalid = 0x8000'0000u;
inline constexpr std::uint32_t kNoRemote = 0x4000'0000u;
}  // namespace cob

/// What an 11-bit identifier means in the pre-defined connection set.
enum class Service : std::uint8_t {
  nmt,
  sync,
  emcy,
  time,
  tpdo1,
  rpdo1,
  tpdo2,
  rpdo2,
  tpdo3,
  rpdo3,
  tpdo4,
  rpdo4,
  sdo_response,
  sdo_request,
  heartbeat,
  lss,
  other,
};
struct CobId {
  Service service = Service::other;
  NodeId node = 0;
  bool operator==(const CobId&) const = default;
};

/// Splits an identifier. Extended, remote-only and reserved identifiers are `other`. real-time safe.
constexpr CobId classify(std::uint32_t id, bool extended = false) noexcept {
  if (extended || id > 0x7FF) return {};
  if (id == cob::kNmt) return {Service::nmt, 0};
  if (id == cob::kSync) return {Service::sync, 0};
  if (id == cob::kTime) return {Service::time, 0};
  if (id == cob::kLssMaster || id == cob::kLssSlave) return {Service::lss, 0};
  const auto node = static_cast<NodeId>(id & 0x7F);
  const std::uint32_t function = id >> 7;
  if (node == 0) return {};
  if (function == 1) return {Service::emcy, node};
  if (function >= 3 && function <= 10)
    return {static_cast<Service>(static_cast<std::uint32_t>(Service::tpdo1) + function - 3), node};
  if (function == 11) return {Service::sdo_response, node};
  if (function == 12) return {Service::sdo_request, node};
  if (function == 14) return {Service::heartbeat, node};
  return {};
}

/// A classic data frame of at most 8 bytes (more are cut off). real-time safe.
inline image::CanFrame make_frame(std::uint32_t id, std::span<const std::uint8_t> bytes) noexcept {
  image::CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(bytes.size() < 8 ? bytes.size() : 8);
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = bytes[i];
  return frame;
}

/// Little-endian integers, as everything in CANopen. `count` 1-8 bytes. real-time safe.
constexpr std::uint64_t load_le(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  if (std::endian::native == std::endian::little && !std::is_constant_evaluated() &&
      bytes.size() >= sizeof value) {
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  for (std::size_t i = 0; i < bytes.size() && i < 8; ++i)
    value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
  return value;
}
constexpr void store_le(std::uint64_t value, std::span<std::uint8_t> bytes) noexcept {
  if (std::endian::native == std::endian::little && !std::is_constant_evaluated() &&
      bytes.size() == sizeof value) {
    std::memcpy(bytes.data(), &value, sizeof value);
    return;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(i < 8 ? value >> (8 * i) : 0);
}

}  // namespace servogate::canopen
