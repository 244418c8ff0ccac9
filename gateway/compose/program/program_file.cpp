// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/program/program_file.hpp"

#include <algorithm>

namespace servogate::gateway {

int open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                 ProgramFile& out) {
  out.dialect = dialect.empty() ? machine.control.dialect : dialect;
  const std::vector<std::string> known = program::dialects();
  if (std::find(known.begin(), known.end(), out.dialect) == known.end()) {
    std::string list;
    for (const std::string& d : known) list += (list.empty() ? "" : ", ") + d;
    complain(kUnknownDialect, {out.dialect, list});
    return kWrongUse;
  }
  std::string error;
  if (!read_file(path, out.text, error)) {
    text::Finding f{text::Severity::error, path, 0, 0, &kCannotRead, {error}};
    print_findings({f});
    return kWrongUse;
  }
  out.model = program_model(machine);
  out.loader = program_loader(path);
  return kDone;
}

}  // namespace servogate::gateway
