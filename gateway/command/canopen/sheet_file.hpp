// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "firmware_if/canopen/inspect/device_sheet.hpp"

namespace servogate::gateway::command {

/// What an EDS that is written now says of itself; `command` is that which writes it.
canopen::SheetOrigin sheet_origin(const std::string& path, const std::string& command);

/// Writes an EDS and says what it holds, and what is missing in it. An exit code.
int write_sheet(const std::string& path, const canopen::DeviceSheet& sheet, canopen::NodeId node);
/// The bytes of a file; what went wrong has been said. An exit code.
int write_bytes(const std::string& path, std::string_view bytes);

}  // namespace servogate::gateway::command
