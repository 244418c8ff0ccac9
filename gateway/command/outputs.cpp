// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/outputs.hpp"

#include <filesystem>

#include "gateway/cli/messages.hpp"
#include "gateway/control/run/can_log.hpp"
#include "gateway/control/run/session.hpp"
#include "report/html.hpp"
#include "report/recorded_run.hpp"
#include "report/trace.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kNothingToLog{
    "can-log.no-bus", "--can-log: no CAN bus of this machine is simulated; `servogate dump` reads a real one",
    "--can-log: у станка нет имитируемой шины CAN; настоящую читает `servogate dump`"};

}  // namespace

int check_outputs(const std::vector<files::NamedPath>& outputs, const std::string& state,
                  const machine::LoadResult& machine, const std::vector<files::NamedPath>& others) {
  std::vector<files::NamedPath> inputs = others;
  inputs.push_back({text::both("the machine file", "файл станка"), machine.machine.file});
  for (const std::string& source : machine.machine.plc.sources)
    inputs.push_back({text::both("the PLC program", "программу ПЛК"), machine.machine.resolve(source)});
  for (const auto& [name, device] : machine.devices)
    inputs.push_back({text::both("a device file", "файл устройства"), device.file});
  auto problem = files::problem_of_outputs(outputs, inputs);
  if (!problem && !state.empty()) problem = files::problem_of_folder(state);
  if (!problem) return kDone;
  complain(*problem->entry, problem->arguments);
  return problem->wrong_use ? kWrongUse : kInfrastructure;
}

int check_can_log(const std::string& folder, const machine::LoadResult& machine) {
  if (folder.empty()) return kDone;
  const auto logs = CanLog::files_of(folder, machine.machine);
  if (logs.empty()) {
    complain(kNothingToLog, {});
    return kWrongUse;
  }
  if (const auto problem = files::problem_of_folder(folder)) {
    complain(*problem->entry, problem->arguments);
    return problem->wrong_use ? kWrongUse : kInfrastructure;
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return check_outputs(logs, {}, machine, {});
}

void fill_provenance(report::Provenance& p, const RunOptions& options, const machine::MachineConfig& machine,
                     const std::vector<std::string>& command_line) {
  report::fill_host(p);
  p.machine = report::identify(options.machine);
  if (!options.program.empty()) p.program = report::identify(options.program);
  for (const std::string& source : machine.plc.sources)
    p.plc.push_back(report::identify(machine.resolve(source)));
  p.clock = name_of(options.clock);
  p.command_line = command_line;
}

void write_outputs_of_no_run(const RunOptions& options, const machine::LoadResult& loaded,
                             const std::vector<std::string>& command_line) {
  if (options.trace.empty() && options.report.empty() && options.html.empty()) return;
  report::Report report;
  report.error = {last_error().code, last_error().text};
  for (const text::Finding& f : loaded.findings)
    if (f.severity == text::Severity::error) report.findings.push_back(f);
  fill_provenance(report.provenance, options, loaded.machine, command_line);
  const auto write = [](const std::string& path, const std::string& content) {
    if (path.empty()) return;
    if (const std::string error = report::write_file(path, content); !error.empty())
      complain(kCannotWrite, {path, error});
  };
  write(options.trace, report::CsvSink::header(trace_layout(loaded.machine)) + "\n");
  write(options.report, report::to_json(report));
  report::HtmlOptions html;
  html.title = loaded.machine.name;
  html.program_name = std::filesystem::path(options.program).filename().string();
  html.language = text::user_language();
  write(options.html, report::to_html(report, report::RecordedRun{}, html));
}

}  // namespace servogate::gateway::command
