// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/program/program_file.hpp"

#include <algorithm>

#include "gateway/files/read_file.hpp"

namespace servogate::gateway {

bool open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                  ProgramFile& out, std::vector<text::Finding>& findings) {
  const auto error = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    findings.push_back({text::Severity::error, path, 0, 0, &entry, std::move(arguments)});
    return false;
  };
  out.dialect = dialect.empty() ? machine.control.dialect : dialect;
  const std::vector<std::string> known = program::dialects();
  if (std::find(known.begin(), known.end(), out.dialect) == known.end()) {
    std::string list;
    for (const std::string& d : known) list += (list.empty() ? "" : ", ") + d;
    return error(kUnknownDialect, {out.dialect, list});
  }
  std::string reason;
  auto content = files::read_file(path, files::kMostOfProgram, reason);
  if (!content) return error(kCannotRead, {reason});
  out.path = path;
  out.text = std::move(*content);
  out.model = program_model(machine);
  out.loader = program_loader(path);
  return true;
}

int open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                 ProgramFile& out) {
  std::vector<text::Finding> findings;
  if (open_program(machine, path, dialect, out, findings)) return kDone;
  print_findings(findings);
  return kWrongUse;
}

}  // namespace servogate::gateway
