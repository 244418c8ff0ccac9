// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/program_option.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

namespace {
const text::Entry kNoSuchProcess{"cli.no-such-process",
                                 "there is no process {0}: the machine file has control.processes = {1}",
                                 "процесса {0} нет: в файле станка control.processes = {1}"};
}  // namespace

int check_dialect(const std::string& dialect) {
  if (dialect.empty() || known_dialect(dialect)) return kDone;
  complain(kUnknownDialect, {dialect, dialect_names()});
  return kWrongUse;
}

int check_process(const machine::MachineConfig& machine, int process) {
  if (process <= machine.control.processes) return kDone;
  complain(kNoSuchProcess, {std::to_string(process), std::to_string(machine.control.processes)});
  return kWrongUse;
}

int open_program_or_say(const machine::MachineConfig& machine, const std::string& path,
                        const std::string& dialect, ProgramFile& out) {
  std::vector<text::Finding> findings;
  const bool opened = open_program(machine, path, dialect, out, findings);
  print_findings(findings);
  return opened ? kDone : kWrongUse;
}

}  // namespace servogate::gateway::command
