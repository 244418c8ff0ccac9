// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gateway/control/compose/simulated/world_setup.hpp"
#include "machine/config.hpp"

namespace servogate::gateway::command {

/// The points of a simulated machine on standard input and output: switches that follow axes are told when
/// they change, inputs are played by a person or a script. Not real-time safe.
class SimPoints {
 public:
  /// Both must live longer. `json`: what is told is a line of JSON each.
  SimPoints(const machine::MachineConfig& machine, mock::World& world, bool json);
  /// Tells what has changed.
  void look(image::Nanoseconds since_start);
  /// `input POINT on|off|auto|NUMBER` with a word of what came of it; false: the line is none of this kind.
  /// Inputs of a drive have names of their own (drive_input()), which a point of the machine goes before.
  bool play(const std::string& line, image::Nanoseconds since_start);

 private:
  struct Switch {
    machine::SimulatedSwitch config;
    int axis;
    bool held = false;  ///< somebody plays it
    std::optional<bool> told;
  };
  const machine::MachineConfig& machine_;
  mock::World& world_;
  bool json_;
  std::vector<Switch> switches_;
};

}  // namespace servogate::gateway::command
