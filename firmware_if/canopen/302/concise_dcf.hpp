// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {

/// One value of a configuration.
struct ConfigurationEntry {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::vector<std::uint8_t> data;  ///< empty: the empty string
  bool operator==(const ConfigurationEntry&) const = default;
};

/// Concise DCF as in 1F22h: number of entries, then index, sub-index, size and data of each, little-endian.
/// Source: CiA 302-3, "Concise DCF". nullopt: cut off or too long. Not real-time safe.
std::optional<std::vector<ConfigurationEntry>> parse_concise_dcf(std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> write_concise_dcf(std::span<const ConfigurationEntry> entries);

/// What a DCF wants written into its device: every ParameterValue that differs from the default and may be
/// written, but for ObjFlags bit 0 and what the boot writes itself anyway (PDOs). Of a DCF that was read
/// without an error nothing is missing. Not real-time safe.
std::vector<ConfigurationEntry> configuration_of(const Eds& dcf, NodeId node);

}  // namespace servogate::canopen
