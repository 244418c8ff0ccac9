// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace servogate::machine {

/// [[pendant]]: a hand-held pendant, a client of the control beside the others.
struct PendantConfig {
  std::string name;
  std::string device;                ///< device file without .toml
  std::string url;                   ///< "mock:NAME", "hid:any", "hid:SERIAL", "hid:/dev/hidraw0"
  std::vector<std::string> axes;     ///< letters of those that it may move; none: all that programs move
  double max_step = 0.1;             ///< mm or degrees a count of its wheel, at most
  std::string dead_man;              ///< button that is held for motion; empty: none
  std::string dead_man_point;        ///< input point that is TRUE for motion; empty: none
  std::vector<std::string> buttons;  ///< meanings instead of those of the device file: "macro: mdi M8"
  bool mock() const { return url.starts_with("mock:"); }
};

/// [[path_wheel]]: the handwheel that drives the programs of a process along their path.
struct PathWheelConfig {
  std::string source;       ///< "handwheel1", "handwheel2" of the PLC, or the name of a pendant
  int process = 1;          ///< from 1
  double full_speed = 100;  ///< counts a second, at which the path has its programmed feed
  std::string healthy;      ///< input point that is TRUE while the counter means something; empty: none
  /// Number of the handwheel of the PLC, 0: a pendant.
  int handwheel() const { return source == "handwheel1" ? 1 : source == "handwheel2" ? 2 : 0; }
};

}  // namespace servogate::machine
