// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "machine/files/output_files.hpp"

namespace servogate::gateway {

/// Writes what passes on the simulated buses of a machine, each to FOLDER/BUS.log in the log format of
/// can-utils, on a thread of its own. Times are those of the control: in virtual time since its beginning. In
/// the cycle a frame costs one place in a bounded queue.
class CanLog {
 public:
  /// Files that a log of this machine has; none without a simulated bus.
  static std::vector<files::NamedPath> files_of(const std::string& folder,
                                                const machine::MachineConfig& machine);

  /// Before the first cycle; `folder` exists.
  CanLog(const std::string& folder, Control& control);
  ~CanLog();
  CanLog(const CanLog&) = delete;
  CanLog& operator=(const CanLog&) = delete;

  /// Blocks until a cycle's frames are sure to find room; for virtual time.
  void wait_for_room() const;
  /// Frames that a full queue did not take.
  std::uint64_t lost() const noexcept;
  /// No cycle runs any more: writes what is queued and closes the files. The error (also: frames were lost),
  /// empty: none.
  std::string close();

 private:
  class Wire;
  void drain();

  Control& control_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace servogate::gateway
