// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check/canon.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/program_option.hpp"

namespace servogate::gateway::command {

int canon(const CanonOptions& options) {
  if (const int code = check_dialect(options.dialect); code != kDone) return code;
  const machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  if (const int code = check_process(loaded.machine, options.process); code != kDone) return code;
  ProgramFile program;
  program.process = options.process - 1;
  if (const int code = open_program_or_say(loaded.machine, options.program, options.dialect, program);
      code != kDone)
    return code;
  std::vector<text::Finding> of_tables;
  program::Tables tables = program_tables(loaded.machine, options.tables, of_tables);
  if (print_findings(of_tables) > 0) return kWrongUse;
  program::Interpreter interpreter(program.dialect, program.model, std::move(tables), options.program,
                                   program.text, program.loader, {}, program.process);
  const auto error = program::write_canon(interpreter, program.model, print_line);
  print_findings(interpreter.warnings());
  if (!error) return kDone;
  print_findings({*error});
  return kAlarm;
}

}  // namespace servogate::gateway::command
