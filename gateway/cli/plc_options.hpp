// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace servogate::gateway {

struct PlcRunOptions {
  std::vector<std::string> files;
  int cycles = 1;
  double cycle_ms = 1.0;
  std::vector<std::string> sets, prints;
};

struct PlcCheckOptions {
  std::vector<std::string> files;
  std::string machine;
};

struct PlcTestOptions {
  std::vector<std::string> files;  ///< tests (.test) and PLC sources
  std::string machine;
  bool json = false;
};

/// `servogate plc ...`
struct PlcCommands {
  PlcRunOptions run;
  PlcCheckOptions check;
  PlcTestOptions test;
};

}  // namespace servogate::gateway
