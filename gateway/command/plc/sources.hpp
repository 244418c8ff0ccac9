// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "plc/compile/compile.hpp"

namespace servogate::gateway::command {

/// What a PLC program is compiled with.
struct PlcSurroundings {
  std::vector<image::Symbol> symbols;
  plc::Options options;
  std::vector<std::string> sources;  ///< the machine's own PLC files
};

/// Reads PLC files. False: one cannot be read, which has been said.
bool read_sources(const std::vector<std::string>& files, std::vector<plc::SourceFile>& out);

/// The symbols of a machine file; an empty path gives none. False: it is not valid, which has been said.
bool read_surroundings(const std::string& machine, PlcSurroundings& out);

}  // namespace servogate::gateway::command
