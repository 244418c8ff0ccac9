// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/cli/options.hpp"
#include "machine/files/output_files.hpp"
#include "machine/load.hpp"
#include "report/report.hpp"

namespace servogate::gateway::command {

/// Before anything moves: kDone when the outputs can be written and overwrite nothing that the command reads,
/// the machine's files and `others`; otherwise the exit code, after saying why. `state`: folder, empty: none.
int check_outputs(const std::vector<files::NamedPath>& outputs, const std::string& state,
                  const machine::LoadResult& machine, const std::vector<files::NamedPath>& others);

/// The folder of `--can-log` before anything moves: kDone when it is there (made, where it was not) and the
/// logs can be written, or none is asked for; otherwise the exit code, after saying why.
int check_can_log(const std::string& folder, const machine::LoadResult& machine);

/// Where the report of a run comes from: host, files, clock, command line.
void fill_provenance(report::Provenance& provenance, const RunOptions& options,
                     const machine::MachineConfig& machine, const std::vector<std::string>& command_line);
/// Trace, report and page of a `run` that ended before its first cycle, so that no older file is taken for
/// them: a trace without rows, a report whose `error` is what was said last.
void write_outputs_of_no_run(const RunOptions& options, const machine::LoadResult& loaded,
                             const std::vector<std::string>& command_line);

}  // namespace servogate::gateway::command
