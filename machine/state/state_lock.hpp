// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/text/finding.hpp"

namespace servogate::machine {

extern const text::Entry kStateTaken;  ///< {0} directory, {1} why it cannot be used

/// Makes a state directory (owner only) where it is missing, and sees that one that is there is a directory
/// of this user, not a link to one: whoever else owns it could make files of this user's out of it. Its mode
/// is left as it is. Empty: done; otherwise why not, in both languages (text::both).
std::string make_state_directory(const std::string& directory);

/// Makes a state directory one control's alone: two would overwrite each other's origins and homing. The file
/// `lock` in it is locked (flock) while this lives and holds the number of the process; the system unlocks it
/// when the process dies, however it does. Not real-time safe.
class StateLock {
 public:
  StateLock() = default;
  ~StateLock();
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;

  /// Locks the directory, making it (owner only) where it is missing. Empty: done. Otherwise why not, in both
  /// languages (text::both): another process has it, by number, or the system's words.
  std::string take(const std::string& directory);

 private:
  int file_ = -1;
};

}  // namespace servogate::machine
