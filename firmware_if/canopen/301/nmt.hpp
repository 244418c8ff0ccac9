// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {

/// NMT command specifier. Source: CiA 301, 7.2.8.3.1 "NMT node control".
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

/// State byte of a heartbeat; boot_up is sent once after a reset. Source: CiA 301, 7.2.8.3.2.
enum class NmtState : std::uint8_t {
  boot_up = 0x00,
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F
};

/// NMT command for one node, or for all with node 0. real-time safe.
inline image::CanFrame nmt_frame(NmtCommand command, NodeId node) noexcept {
  const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(command), node};
  return make_frame(cob::kNmt, bytes);
}

struct NmtRequest {
  NmtCommand command = NmtCommand::start;
  NodeId node = 0;
};
/// Reads an NMT command; nullopt when the frame is none (wrong length, unknown command). real-time safe.
constexpr std::optional<NmtRequest> parse_nmt(const image::CanFrame& frame) noexcept {
  if (frame.id != cob::kNmt || frame.extended || frame.remote || frame.length != 2) return std::nullopt;
  switch (const auto command = static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::start:
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      return NmtRequest{command, frame.data[1]};
  }
  return std::nullopt;
}

/// Heartbeat (or boot-up) of a node. real-time safe.
inline image::CanFrame heartbeat_frame(NodeId node, NmtState state) noexcept {
  const std::array<std::uint8_t, 1> bytes{static_cast<std::uint8_t>(state)};
  return make_frame(cob::heartbeat(node), bytes);
}
/// State in a heartbeat; the toggle bit of node guarding is ignored; nullopt for an undefined state.
/// real-time safe.
constexpr std::optional<NmtState> parse_heartbeat(const image::CanFrame& frame) noexcept {
  if (frame.remote || frame.length != 1) return std::nullopt;
  switch (const auto state = static_cast<NmtState>(frame.data[0] & 0x7F)) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational:
      return state;
  }
  return std::nullopt;
}

}  // namespace servogate::canopen
