// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// Steps of the boot of a node, in order. Source: CiA 302-2, "Boot slave process".
enum class BootStep : std::uint8_t {
  reset,               ///< NMT reset communication sent, boot-up message awaited
  device_type,         ///< 1000h
  identity,            ///< 1018h:01-04
  software_version,    ///< 100Ah
  program,             ///< 1F56h compared; 1F51h, 1F50h, 1F57h where it is another one
  supported_modes,     ///< 6502h
  encoder_resolution,  ///< 6501h, 6502h, of an encoder
  configuration,       ///< 1020h compared; concise DCF where it is another one
  settings,            ///< the device file's own values
  homing,              ///< 60E3h, 6098h, 6099h, 609Ah, 607Ch, for an axis that its drive homes
  node_guarding,       ///< 100Ch, 100Dh, for a node without heartbeat
  heartbeat_consumer,  ///< 1016h:01, our heartbeat
  abort_connection,    ///< 6007h
  error_states,        ///< 1029h, 6206h, 6207h, 6443h, 6444h, for the outputs of an I/O module
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
enum class BootProblem : std::uint8_t {
  none,
  no_answer,
  aborted,
  wrong_value,
  wrong_length,
  bad_protocol,
  wrong_text,    ///< `expected_text`, `got_text`
  flash_error,   ///< `got`: 1F57h
  not_in_list,   ///< `expected` is none of the `got` entries of an array
  flash_timeout  ///< the flash is still at work; `got`: 1F57h
};

/// A text of fixed size in an event; longer ones are cut off.
struct BootText {
  std::array<char, 32> bytes{};
  BootText() = default;
  explicit BootText(std::string_view text) noexcept {
    std::copy_n(text.begin(), std::min(text.size(), bytes.size() - 1), bytes.begin());
  }
  std::string_view view() const noexcept { return bytes.data(); }
};

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
  BootText expected_text = {}, got_text = {};
};

/// Words for the error in 1F57h (bits 1-7). Source: CiA 302-3, "Flash status identification". real-time safe.
const text::Entry& flash_error_text(std::uint32_t status) noexcept;

/// What a device file or machine file has to say of a device that refused the access because it cannot do it:
/// `connection_loss = "none"`; empty: there is nothing to say. real-time safe.
std::string_view boot_waiver(const BootReport& report) noexcept;

/// Name of a step. real-time safe.
const text::Entry& boot_step_text(BootStep step) noexcept;

}  // namespace servogate::canopen
