// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/canopen/inspect/sdo_access.hpp"

/// Objects of a drive that a run writes and puts back. Meanwhile they stand in the file `changed.json` of the
/// run's directory, so that a run which was cut off (killed, no power) is put right by the next one. Not
/// real-time safe.
namespace servogate::gateway::command {

/// Which drive: by its place, and by what it says of itself where it does.
struct DriveMark {
  std::string bus;
  canopen::NodeId node = 0;
  std::optional<std::int64_t> product, serial;  ///< 1018h:02 and :04
};

class ChangedObjects {
 public:
  /// `folder`: the run's directory; empty: nothing is kept.
  ChangedObjects(canopen::SdoAccess& access, DriveMark mark, std::string folder);
  ChangedObjects(const ChangedObjects&) = delete;
  ChangedObjects& operator=(const ChangedObjects&) = delete;

  /// Writes an object of up to four bytes and remembers what it was, in the file first. Empty: done, or it is
  /// 6072h and the drive has none, which has been said; otherwise why not.
  std::string change(std::uint16_t index, std::int64_t value);
  /// Writes them back in reverse order; what fails is said and stays in the file.
  void restore();

 private:
  struct Changed {
    std::uint16_t index = 0;
    std::vector<std::uint8_t> before, during;
  };
  std::string write_file() const;

  canopen::SdoAccess& access_;
  DriveMark mark_;
  std::string folder_;
  std::vector<Changed> changed_;
};

/// Puts right what cut off runs in the folder around `out`, or in those beside it, have left in this drive:
/// an object that still is as the run wrote it becomes what it was before, which is said. What somebody has
/// written since stays. False: an object could not be put right, which has been said.
bool put_right(canopen::SdoAccess& access, const DriveMark& mark, const std::string& out);

}  // namespace servogate::gateway::command
