// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/text/finding.hpp"

/// Not real-time safe.
namespace servogate::canopen {

/// What an SDO access came to.
struct SdoOutcome {
  SdoStatus status = SdoStatus::no_answer;
  AbortCode abort = AbortCode::none;
  std::vector<std::uint8_t> data;  ///< what was read
  bool ok() const noexcept { return status == SdoStatus::done; }
  /// The device answered, with data or with an abort.
  bool answered() const noexcept { return status == SdoStatus::done || status == SdoStatus::aborted; }
  /// "0602 0000h: the object does not exist in the device", or that nobody answers.
  std::string why(text::Language language = text::user_language()) const;
};

/// How the objects of a node are reached, each access until its answer: over a bus, or through the control
/// that holds it.
class SdoAccess {
 public:
  virtual ~SdoAccess() = default;
  virtual SdoOutcome read(NodeId node, std::uint16_t index, std::uint8_t subindex) = 0;
  virtual SdoOutcome write(NodeId node, std::uint16_t index, std::uint8_t subindex,
                           std::span<const std::uint8_t> data) = 0;
};

}  // namespace servogate::canopen
