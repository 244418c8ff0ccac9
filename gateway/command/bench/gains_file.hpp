// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/drive/tuning/loop_tuning.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/inspect/sdo_access.hpp"

/// Where a drive has the gains of its loops, which CiA 402 leaves to its maker. Not real-time safe.
namespace servogate::gateway::command {

/// One gain: the object that holds it, and what one of it is.
struct GainObject {
  std::string name;  ///< "velocity_gain"
  canopen::ObjectAddress at;
  double unit = 1.0;
  bool inverse = false;  ///< it holds the reciprocal: an integral time instead of a rate
  double bench::LoopGains::*gain = nullptr;
};
struct GainsFile {
  std::string path;
  std::vector<GainObject> objects;  ///< velocity_gain always, the others where the drive has them
  bool has(double bench::LoopGains::*gain) const;
  /// Both objects of a notch.
  bool has_notch() const;
};

/// Reads a gains file (docs/bench.md). nullopt: it is wrong, which has been said with its line.
std::optional<GainsFile> read_gains_file(const std::string& path);

/// The gains as the drive has them, and their bytes in the order of the file's objects.
struct StandingGains {
  bench::LoopGains gains;
  std::vector<std::vector<std::uint8_t>> bytes;
};
/// nullopt: one cannot be read, which has been said.
std::optional<StandingGains> read_gains(canopen::SdoAccess& access, canopen::NodeId node,
                                        const GainsFile& file);
/// Writes them, as exactly as their units allow, into objects that stand as `standing` says, and reads them
/// back into `gains`. False: one was refused, which has been said.
bool write_gains(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file,
                 const StandingGains& standing, bench::LoopGains& gains);
/// Writes all bytes back. False: some were refused, each of which has been said.
bool restore_gains(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file,
                   const StandingGains& standing);
/// The gains as a DCF that `servogate od --restore` writes back into this device. Empty: they cannot be read.
std::string gains_dcf(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file);

}  // namespace servogate::gateway::command
