// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/sources.hpp"
#include "machine/consequences.hpp"
#include "plc/run/run.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kBadSet{"cli.plc-set", "'{0}' is not of the form NAME=VALUE or NAME=VALUE@CYCLE",
                          "«{0}» не имеет вида ИМЯ=ЗНАЧЕНИЕ или ИМЯ=ЗНАЧЕНИЕ@ЦИКЛ"};

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
  for (const std::string& list : options.prints)
    for (std::string& name : plc::parse_prints(list)) request.prints.push_back(std::move(name));
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
  PlcSurroundings surroundings;
  if (!read_surroundings(options.machine, surroundings)) return kWrongUse;
  std::vector<text::Finding> findings;
  const bool good = plc::check(files, surroundings.symbols, surroundings.options, findings);
  const int errors = print_findings(findings);
  if (options.json)
    print_exact(
        nlohmann::json{{"schema", 1},
                       {"errors", errors},
                       {"findings", nlohmann::json::parse(machine::to_json(findings), nullptr, false)}}
            .dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  return good ? kDone : kAlarm;
}

}  // namespace servogate::gateway::command
