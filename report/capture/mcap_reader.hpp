// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "report/capture/layout.hpp"

namespace servogate::report {

/// What keeps a file from being read, for people.
struct UnreadCapture {
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
};

/// Reads an MCAP file that a capture has written and hands it to `sink`, begin() and end() included, in the
/// order of the file. nullopt: read to its end; otherwise why not, with the place in bytes, and the sink has
/// what was sound before it. Chunks that others have compressed are not read. Not for the cycle.
std::optional<UnreadCapture> read_mcap(const std::string& path, CaptureSink& sink);

}  // namespace servogate::report
