// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/control/server/protocol/plc_reply.hpp"
#include "plc/logic/logic.hpp"

namespace servogate::gateway {

/// The symbols of a PLC program as `plc list` gives them: name, type, place in a packet, retain, and the
/// places of the source (`mill.st:33`) where each is written and read. Members of function blocks stand as
/// `Block.member`, for all instances.
std::vector<PlcSymbol> list_symbols(const plc::Image& image);

/// What a watch shows beside the lines of a body.
struct WatchedValue {
  std::string name;
  const plc::Type* type = nullptr;
  std::uint32_t address = 0;
};
struct WatchedLine {
  int line = 0;
  std::string text;
  std::vector<WatchedValue> values;
};
struct WatchedBody {
  std::string file;
  std::vector<WatchedLine> lines;
};

/// The lines of a program, or of an instance of a function block (`Mill.change`), with the elementary
/// variables that stand in each; empty lines: there is no such body.
WatchedBody watched_body(const plc::LogicProgram& program, const std::string& name);
/// Names of the programs.
std::vector<std::string> program_names(const plc::Image& image);

}  // namespace servogate::gateway
