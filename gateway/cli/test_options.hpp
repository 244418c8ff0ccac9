// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gateway/control/run/clock_kind.hpp"

namespace servogate::gateway {

struct TestOptions {
  std::string session;             ///< a machine file: another program steps it; empty: none
  std::vector<std::string> paths;  ///< files, and directories that are searched through
  int jobs = 0;                    ///< worker processes; 0: one a core
  std::string shard;               ///< "I/N": every N-th scenario, beginning with the I-th
  std::vector<std::string> tags;   ///< only scenarios with one of them
  std::string name;                ///< only scenarios whose name contains it
  std::string junit, json;         ///< files; empty: none
  std::string artifacts;           ///< folder for trace and page of what fails
  std::string trace_table;         ///< file for the table of requirements
  std::optional<std::uint64_t> seed;
  ClockKind clock = ClockKind::unset;
  bool shrink = false;
  bool tap = false;
  bool list = false;  ///< only names them
  bool real = false;  ///< machines with real buses and devices are allowed
  bool without_faults = false;
  bool quiet = false;
};

}  // namespace servogate::gateway
