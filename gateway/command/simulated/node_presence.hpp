// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "gateway/command/signals.hpp"
#include "gateway/control/compose/can_transport.hpp"

namespace servogate::gateway::command {

/// Whether every node-ID is named once; one that is not has been said (exit code kWrongUse).
bool each_once(const std::vector<int>& nodes);

/// Before simulated devices join a bus: listens a moment for frames that only devices with these node-IDs
/// send. With `ask` it asks them for 1000h, too, where no master was heard: one would take the question for
/// that of a second master, and so would one that is starting. kDone: nobody has them; kAlarm, after saying
/// who was heard. At most a second. Not real-time safe.
int may_join(const CanTransport& transport, const std::string& url, const std::vector<int>& nodes, bool ask,
             const EndBySignal& signals);

/// Notices that another device speaks under a node-ID of this process, and says it once for each. Not
/// real-time safe.
class TwinWatch {
 public:
  /// `own`: whether a device of this process has the node-ID now.
  TwinWatch(std::string url, std::function<bool(int node)> own)
      : url_(std::move(url)), own_(std::move(own)) {}
  /// A frame from outside.
  void hear(const image::CanFrame& frame);

 private:
  std::string url_;
  std::function<bool(int node)> own_;
  std::set<int> told_;
};

}  // namespace servogate::gateway::command
