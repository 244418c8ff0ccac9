// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::candump {

/// One line of a log.
struct Line {
  image::Nanoseconds time = 0;  ///< since 1970; of a log in virtual time since its beginning
  std::string bus;              ///< name of the interface
  image::CanFrame frame;        ///< its time stamp is `time`
};

/// "(1436509052.249713) vcan0 181#DEAD", without line end. Source: can-utils, lib.h, "CAN frame ASCII
/// representation". Not real-time safe.
std::string format(const image::CanFrame& frame, image::Nanoseconds time, std::string_view bus);
/// nullopt: no such line. Direction marks behind the frame (R, T) are read over. Not real-time safe.
std::optional<Line> parse(std::string_view text);

}  // namespace servogate::candump
