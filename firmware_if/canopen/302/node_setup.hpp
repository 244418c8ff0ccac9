// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace servogate::canopen {

/// 1020h: when the configuration of a node was made. Days since 1984-01-01 and milliseconds after midnight.
/// Source: CiA 302-3, "Verify configuration".
struct ConfigurationDate {
  std::uint32_t days = 0, milliseconds = 0;
};

/// Program of a node and what it says of itself once it runs. Source: CiA 302-3, "Program download".
struct NodeProgram {
  std::vector<std::uint8_t> image;   ///< for 1F50h; empty: the node is refused instead of programmed
  std::uint32_t identification = 0;  ///< 1F56h of the right program
  std::uint8_t number = 1;           ///< sub-index of 1F50h, 1F51h, 1F56h, 1F57h
};

/// What one node, not its make, is to be before it may run. Everything may be left out.
struct NodeSetup {
  std::string software_version;  ///< 100Ah, compared to the letter
  std::optional<NodeProgram> program;
  std::vector<std::uint8_t> concise_dcf;  ///< as in 1F22h, written before the PDOs
  /// With it the concise DCF is written only where 1020h tells another date, which is written after it.
  std::optional<ConfigurationDate> configuration_date;
  std::int32_t boot_timeout_ms = 0;          ///< 0: the segment's
  std::int32_t boot_attempts = 0;            ///< 0: the segment's
  std::int32_t program_timeout_ms = 60'000;  ///< of clearing and of writing the flash
};

}  // namespace servogate::canopen
