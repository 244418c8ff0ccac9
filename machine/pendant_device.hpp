// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace servogate::machine {

/// What its wheel says: nothing, signed counts since the last report, or a byte that counts round.
enum class PendantWheel : std::uint8_t { none, delta, counter };

/// [pendant] of a device file: reports and display of a pendant, in the words of
/// firmware_if/pendant/layout.hpp. Places are bytes of the report from 0; -1: it has none.
struct PendantMap {
  std::int64_t usb_vendor = 0, usb_product = 0;
  std::string source;  ///< where its reports are documented
  std::string tested;  ///< what this file was tried on
  int report_number = 0;
  int report_bytes = 0;
  int first_key = -1, second_key = -1;
  int bits = -1;
  int axis = -1, step = -1, wheel = -1, ring = -1;
  PendantWheel wheel_kind = PendantWheel::none;
  int ring_range = 7, ring_from = 1;
  std::vector<std::string> buttons, axes, steps, meanings;
  int display_number = 0, display_bytes = 0;
  std::vector<std::string> display;
};

}  // namespace servogate::machine
