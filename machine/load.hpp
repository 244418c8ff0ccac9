// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/canopen/302/node_setup.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/config.hpp"
#include "machine/device.hpp"

namespace servogate::machine {

/// A machine file read, with the device files it names.
struct LoadResult {
  MachineConfig machine;
  std::map<std::string, DeviceConfig, std::less<>> devices;  ///< by name in the machine file
  std::vector<text::Finding>
      findings;  ///< all of the file and its device files, errors and warnings, by place
  /// Files that nodes name, read: by "bus.node".
  struct NodeFiles {
    std::vector<std::uint8_t> program;
    std::vector<std::uint8_t> concise_dcf;  ///< of `configuration`, as in 1F22h
    std::optional<canopen::ConfigurationDate> configuration_date;
  };
  std::map<std::string, NodeFiles, std::less<>> node_files;
  bool readable = true;  ///< false: there was no content to judge (missing, no regular file, too large)
  /// No error; warnings are allowed.
  bool ok() const;
  /// Device of a node or station, nullptr when it could not be read.
  const DeviceConfig* device(std::string_view name) const;
};

/// Where device files are looked for after the machine file's own folder and its devices/.
/// $SERVOGATE_DEVICES, then ../share/servogate/devices of an installed program, or else the source tree's
/// devices/ where it is there.
std::vector<std::string> device_folders();

/// Reads and checks a machine file: keys, units, ranges, references, places, dangerous choices, consequences.
/// Never throws on a bad file; a file that cannot be read is a finding. Findings end at the first TOML syntax
/// error.
LoadResult load(const std::string& path);
/// The same from memory; `path` gives the folder for names in the file and the name in findings.
LoadResult parse(std::string_view text, const std::string& path);

/// The published JSON schema of the machine file (docs/machine.schema.json), from the same table of keys that
/// validates it.
std::string json_schema();

}  // namespace servogate::machine
