// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/plc/sources.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/control/compose/plc/logic_options.hpp"
#include "machine/files/read_file.hpp"
#include "machine/load.hpp"

namespace servogate::gateway::command {

bool read_sources(const std::vector<std::string>& files, std::vector<plc::SourceFile>& out) {
  for (const std::string& name : files) {
    std::string reason;
    auto content = files::read_file(name, files::kMostOfSource, reason);
    if (!content) {
      print_findings({{text::Severity::error, name, 1, 1, &kCannotRead, {reason}}});
      return false;
    }
    out.push_back({name, std::move(*content)});
  }
  return true;
}

bool read_surroundings(const std::string& machine, PlcSurroundings& out) {
  if (machine.empty()) return true;
  const machine::LoadResult loaded = machine::load(machine);
  if (print_findings(loaded.findings) > 0) return false;
  out.symbols = loaded.machine.symbol_table();
  out.options = logic_options(loaded.machine);
  for (const std::string& source : loaded.machine.plc.sources)
    out.sources.push_back(loaded.machine.resolve(source));
  return true;
}

}  // namespace servogate::gateway::command
