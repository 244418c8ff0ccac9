// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// Steps of the boot of a node, in order. Source: CiA 302-2, "Boot slave process", without download of
/// programs.
enum class BootStep : std::uint8_t {
  reset,               ///< NMT reset communication sent, boot-up message awaited
  device_type,         ///< 1000h
  identity,            ///< 1018h:01-04
  supported_modes,     ///< 6502h
  settings,            ///< the device file's own values
  node_guarding,       ///< 100Ch, 100Dh, for a node without heartbeat
  heartbeat_consumer,  ///< 1016h:01, our heartbeat
  abort_connection,    ///< 6007h
  sync,                ///< 1005h, 1006h
  rpdo,                ///< 1400h+n, 1600h+n
  tpdo,                ///< 1800h+n, 1A00h+n
  interpolation_time,  ///< 60C2h
  mode,                ///< 6060h
  heartbeat_producer,  ///< 1017h
  start,               ///< NMT start sent, heartbeat with state Operational awaited
  done,
};

/// Why a step failed.
enum class BootProblem : std::uint8_t { none, no_answer, aborted, wrong_value, wrong_length, bad_protocol };

/// Where a boot stands or failed. Plain data.
struct BootReport {
  BootStep step = BootStep::reset;
  BootProblem problem = BootProblem::none;
  std::uint16_t index = 0;  ///< object, 0 where the step is no SDO access
  std::uint8_t subindex = 0;
  bool writing = false;
  AbortCode abort = AbortCode::none;
  std::uint32_t expected = 0;
  std::uint32_t got = 0;
};

/// Name of a step. real-time safe.
const text::Entry& boot_step_text(BootStep step) noexcept;

}  // namespace servogate::canopen
