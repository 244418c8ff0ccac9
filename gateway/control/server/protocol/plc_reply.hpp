// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

struct ForcedValue {
  std::string name, value, user;
  bool stays = false;  ///< beyond its client
};

/// A variable or place with its value as JSON writes it: `true`, `-3`, `"ABC"`, `null`.
struct PlcValue {
  std::string name, value;
  std::optional<std::string> forced;  ///< the value that was asked for
};
/// Times of a task or a block, in microseconds.
struct PlcTimes {
  std::string name;
  double last_us = 0.0, average_us = 0.0, most_us = 0.0;
  std::uint64_t count = 0;
};
/// Whole values of one scan.
struct PlcValues {
  std::int64_t cycle = 0;
  double time_s = 0.0;
  std::vector<PlcValue> values;
  std::vector<ForcedValue> forced;
  bool timed = false;
  std::vector<PlcTimes> tasks, blocks;
};
/// The lines of a body with the values that stand in each.
struct PlcBody {
  struct Line {
    int line = 0;
    std::string text;
    std::vector<PlcValue> values;
  };
  std::int64_t cycle = 0;
  double time_s = 0.0;
  std::string body, file;
  std::vector<Line> lines;
  std::vector<ForcedValue> forced;
};
struct PlcSymbol {
  std::string name, type;
  std::string place;  ///< in a packet; empty: none
  bool retain = false;
  std::vector<std::string> written, read;  ///< where, as `mill.st:33`
  std::optional<std::string> forced;
};
struct PlcSymbols {
  std::vector<std::string> files;
  std::vector<PlcSymbol> symbols;
  std::vector<ForcedValue> forced;
};
/// Another program of the PLC has been taken; of a refused one the findings alone.
struct PlcLoaded {
  std::vector<text::Finding> findings;
  bool taken = false;
  std::vector<std::string> files;
  bool online = false;
  std::size_t kept = 0;
  std::vector<std::string> fresh, given_up, forces_lost, set_aside, taken_back, lost;
};

}  // namespace servogate::gateway
