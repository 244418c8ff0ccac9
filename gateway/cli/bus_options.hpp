// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace servogate::gateway {

/// `servogate can bus`: a bus server for other processes.
struct CanBusOptions {
  std::vector<std::string> names;
  std::string listen = "127.0.0.1:29536";
  double bit_rate = 1'000'000.0;  ///< bit/s
  int lockstep = 0;
  double until = 0.0;  ///< s
  std::string log;
};

/// `servogate drive`: simulated drives as a process of their own.
struct DriveOptions {
  std::string bus;
  std::vector<int> nodes;
  std::string device;
  double bit_rate = 1'000'000.0;  ///< bit/s
};

/// `servogate dump`: a bus as a log of can-utils.
struct DumpOptions {
  std::string bus;
  double bit_rate = 1'000'000.0;  ///< bit/s
  std::int64_t count = 0;         ///< frames, 0: no end
  double seconds = 0.0;           ///< 0: no end
};

/// `servogate play`: such a log back onto a bus.
struct PlayOptions {
  std::string bus, file;
  double bit_rate = 1'000'000.0;  ///< bit/s
  double speed = 1.0;
  bool may_move = false;
};

/// Options of the commands that work on a bus.
struct BusCommands {
  CanBusOptions can_bus;
  DriveOptions drive;
  DumpOptions dump;
  PlayOptions play;
};

}  // namespace servogate::gateway
