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
  bool json = false;
};

struct PlcTestOptions {
  std::vector<std::string> files;  ///< tests (.test) and PLC sources
  std::string machine;
  std::string junit;  ///< file; empty: none
  bool json = false;
};

struct PlcListOptions {
  std::vector<std::string> files;  ///< none: the running control's program
  std::string machine, socket;
  bool json = false;
};

struct PlcWatchOptions {
  std::vector<std::string> names;
  std::string body;  ///< program or instance whose lines are shown
  std::string socket;
  double every_ms = 500.0;
  int samples = 0;  ///< 0: until Ctrl-C
  bool times = false, json = false;
};

struct PlcStepOptions {
  std::vector<std::string> names;
  std::string body;  ///< program or instance whose lines are shown
  std::string socket;
  int scans = 0;  ///< 0: one for each Enter, until Ctrl-C
  bool json = false;
};

struct PlcForceOptions {
  std::vector<std::string> settings;  ///< NAME=VALUE, or names to be let go
  std::string socket;
  bool release = false, stay = false, json = false;
};

struct PlcLoadOptions {
  std::vector<std::string> files;  ///< none: those of the machine file
  std::string socket;
  bool online = false, while_running = false, json = false;
};

/// `servogate plc ...`
struct PlcCommands {
  PlcRunOptions run;
  PlcCheckOptions check;
  PlcTestOptions test;
  PlcListOptions list;
  PlcWatchOptions watch;
  PlcStepOptions step;
  PlcForceOptions force;
  PlcLoadOptions load;
};

}  // namespace servogate::gateway
