// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/files/read_file.hpp"
#include "gateway/machine/load.hpp"
#include "plc/run.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kBadSet{"cli.plc-set", "'{0}' is not of the form NAME=VALUE or NAME=VALUE@CYCLE",
                          "«{0}» не имеет вида ИМЯ=ЗНАЧЕНИЕ или ИМЯ=ЗНАЧЕНИЕ@ЦИКЛ"};

bool read_sources(const std::vector<std::string>& files, std::vector<plc::SourceFile>& out) {
  for (const std::string& name : files) {
    std::string reason;
    auto content = files::read_file(name, files::kMostOfSource, reason);
    if (!content) {
      print_findings({{text::Severity::error, name, 0, 0, &kCannotRead, {reason}}});
      return false;
    }
    out.push_back({name, std::move(*content)});
  }
  return true;
}

}  // namespace

int plc_run(const PlcRunOptions& options) {
  plc::RunRequest request;
  if (!read_sources(options.files, request.files)) return kWrongUse;
  request.cycles = options.cycles;
  request.cycle_ns = std::llround(options.cycle_ms * 1e6);
  for (const std::string& s : options.sets) {
    plc::RunSet set;
    if (!plc::parse_set(s, set)) {
      complain(kBadSet, {s});
      return kWrongUse;
    }
    request.sets.push_back(set);
  }
  request.prints = options.prints;
  const plc::RunResult result = plc::run(request, print_line);
  print_findings(result.findings);
  switch (result.end) {
    case plc::RunResult::End::done:
      return kDone;
    case plc::RunResult::End::fault:
      return kAlarm;
    case plc::RunResult::End::bad_source:
    case plc::RunResult::End::wrong_use:
      return kWrongUse;
  }
  return kWrongUse;
}

int plc_check(const PlcCheckOptions& options) {
  std::vector<plc::SourceFile> files;
  if (!read_sources(options.files, files)) return kWrongUse;
  std::vector<image::Symbol> symbols;
  plc::Options plc_options;
  if (!options.machine.empty()) {
    const machine::LoadResult loaded = machine::load(options.machine);
    if (print_findings(loaded.findings) > 0) return kWrongUse;
    symbols = loaded.machine.symbol_table();
    plc_options.k_bytes = static_cast<std::uint32_t>(loaded.machine.control.k_size);
    plc_options.v_bytes = static_cast<std::uint32_t>(loaded.machine.control.syvar_size);
  }
  std::vector<text::Finding> findings;
  const bool good = plc::check(files, symbols, plc_options, findings);
  print_findings(findings);
  return good ? kDone : kAlarm;
}

}  // namespace servogate::gateway::command
