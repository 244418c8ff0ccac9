// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/image/time.hpp"
#include "gateway/control/compose/control.hpp"
#include "machine/load.hpp"

namespace servogate::gateway::command {

/// Makes a control the only master of its buses: one that starts resets the communication of every node, and
/// the drives of another control would stop in motion. In this order: claim(), compose the control, listen(),
/// its first cycle. Both look at buses only that somebody else can be on; a mock bus lives inside its
/// control. The buses are this process's own until the object ends. Not real-time safe.
class SoleMaster {
 public:
  SoleMaster() = default;
  ~SoleMaster();
  SoleMaster(const SoleMaster&) = delete;
  SoleMaster& operator=(const SoleMaster&) = delete;

  /// Asks the controls and runs of this user, and takes the claim of each bus, so that of two that start at
  /// the same time one does. kDone, or kAlarm after saying who has the bus.
  int claim(const machine::LoadResult& loaded);
  /// Listens for whoever is no control of this user. Nodes that a master left behind speak, too: only what
  /// leads nodes counts (canopen::leads_nodes()). Of several controls that listen at the same time one goes
  /// on (canopen::MasterClaim). kDone, or kAlarm after saying what was heard and how often.
  static int listen(Control& control);

  /// How long listen() listens: longer than the slowest SYNC of a control, a heartbeat once a second, and
  /// the heartbeats that the nodes of this machine are given; 10 s at most.
  static image::Nanoseconds patience(const machine::MachineConfig& machine);

 private:
  std::vector<int> claims_;  ///< open files
};

}  // namespace servogate::gateway::command
