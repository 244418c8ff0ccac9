// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/run/announce.hpp"
#include "machine/state/state.hpp"

namespace servogate::gateway {

/// Writes the PLC's retained variables to the state directory whenever they have changed, on a thread of its
/// own: at most kPause and the time of one write lie between a scan and its values on the disk, so that a
/// power cut or `kill -9` costs no more than that.
class RetainedKeeper {
 public:
  /// `generation`: MachineState::retained_generation of what was loaded. A machine without PLC, and an empty
  /// `folder`, keep nothing. `announce`: hears, from the thread, what could not be written.
  RetainedKeeper(Control& control, std::string folder, std::int64_t generation, Announce announce = {});
  ~RetainedKeeper();
  RetainedKeeper(const RetainedKeeper&) = delete;

  /// Writes what has changed since and ends the thread; after the last cycle. The system's words when
  /// something could not be written, empty: all is kept.
  std::string close();

 private:
  void keep();
  bool write_changed();

  Control& control_;
  Announce announce_;
  machine::StateDirectory directory_;
  std::int64_t generation_;
  std::shared_ptr<const plc::LogicProgram> program_;  ///< whose values are on the disk
  std::uint64_t written_ = 0;                         ///< and their version
  std::string problem_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace servogate::gateway
