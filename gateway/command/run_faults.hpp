// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/command/simulated/fault_line.hpp"
#include "gateway/control/run/running_machine.hpp"

namespace servogate::gateway::command {

/// Faults of what a running machine simulates: `--fault "kill node=2 at=30"`, `--script FILE` and lines of
/// standard input, in the words of `sim` and `drive`.
class RunFaults {
 public:
  explicit RunFaults(RunningMachine& machine) : machine_(machine) {}
  /// False: a line is wrong, or a fault cannot happen to its device, which has been said.
  bool plan(const std::vector<std::string>& lines, const std::string& script);
  /// A line of standard input at this machine time, from which its own times count. False: as above.
  bool take(const std::string& line, image::Nanoseconds now);
  /// Puts in what is due at this machine time.
  void poll(image::Nanoseconds now);

 private:
  struct Due {
    image::Nanoseconds at = 0;
    std::string device, words;
    DriveDeed deed;
  };
  bool add(const DriveDeed& deed, const std::string& place);

  RunningMachine& machine_;
  std::vector<Due> due_;  ///< in order of time
  std::size_t done_ = 0;
};

}  // namespace servogate::gateway::command
