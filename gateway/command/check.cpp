// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "gateway/command/commands.hpp"
#include "gateway/compose/program/program_file.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/machine/state.hpp"
#include "plc/run.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kTravelLine{"check.extent", "{0}: {1} to {2} of {3} to {4} {5}",
                              "{0}: от {1} до {2} при ходе от {3} до {4} {5}"};
const text::Entry kTimeLine{"check.time", "{0}: {1} blocks, about {2} s, {3} mm of path",
                            "{0}: кадров {1}, около {2} с, путь {3} мм"};
const text::Entry kToolLine{"check.tool", "tool {0} corrector {1}, first in line {2}, called {3} times",
                            "инструмент {0}, корректор {1}, впервые в строке {2}, вызовов: {3}"};
std::string sentence(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

void check_logic(const machine::MachineConfig& machine, std::vector<text::Finding>& findings) {
  std::vector<plc::SourceFile> sources;
  for (const std::string& name : machine.plc.sources) {
    plc::SourceFile source{machine.resolve(name), {}};
    std::string error;
    if (!read_file(source.name, source.text, error)) return;  // the machine file's check says it
    sources.push_back(std::move(source));
  }
  if (sources.empty()) return;
  plc::Options options;
  options.k_bytes = static_cast<std::uint32_t>(machine.control.k_size);
  options.v_bytes = static_cast<std::uint32_t>(machine.control.syvar_size);
  plc::check(sources, machine.symbol_table(), options, findings);
}

nlohmann::json describe(const program::CheckReport& report, const program::MachineModel& model,
                        const std::string& name) {
  nlohmann::json json{{"program", name},
                      {"finished", report.finished},
                      {"blocks", report.blocks},
                      {"executed", report.executed},
                      {"time_s", report.feed_seconds + report.rapid_seconds + report.dwell_seconds},
                      {"path_mm", report.path_mm}};
  for (std::size_t a = 0; a < report.extents.size(); ++a)
    json["extents"][model.axes[a].letter] = {{"min", report.extents[a].min},
                                             {"max", report.extents[a].max},
                                             {"travel_min", report.extents[a].travel_min},
                                             {"travel_max", report.extents[a].travel_max},
                                             {"outside_line", report.extents[a].outside_line}};
  json["tools"] = nlohmann::json::array();
  for (const auto& t : report.tools)
    json["tools"].push_back(
        {{"number", t.number}, {"corrector", t.corrector}, {"line", t.line}, {"calls", t.calls}});
  return json;
}

void print_report(const program::CheckReport& report, const program::MachineModel& model,
                  const std::string& name) {
  std::printf(
      "%s\n",
      sentence(kTimeLine, {name, std::to_string(report.blocks),
                           text::number(report.feed_seconds + report.rapid_seconds + report.dwell_seconds, 1),
                           text::number(report.path_mm, 1)})
          .c_str());
  for (std::size_t a = 0; a < report.extents.size(); ++a) {
    const auto& e = report.extents[a];
    if (!e.moved) continue;
    std::printf("  %s\n",
                sentence(kTravelLine, {model.axes[a].letter, text::number(e.min, 3), text::number(e.max, 3),
                                       text::number(e.travel_min, 3), text::number(e.travel_max, 3),
                                       model.axes[a].rotary ? "deg" : "mm"})
                    .c_str());
  }
  for (const auto& t : report.tools)
    std::printf("  %s\n", sentence(kToolLine, {std::to_string(t.number), std::to_string(t.corrector),
                                               std::to_string(t.line), std::to_string(t.calls)})
                              .c_str());
}

}  // namespace

int check(const CheckOptions& options) {
  const machine::LoadResult loaded = machine::load(options.machine);
  std::vector<text::Finding> findings = loaded.findings;
  if (loaded.ok()) check_logic(loaded.machine, findings);
  int machine_errors = print_findings(findings);
  nlohmann::json json;
  if (options.json) {
    json["schema"] = 1;
    json["machine"] = nlohmann::json::parse(machine::to_json(loaded, machine::consequences(loaded)));
    json["findings"] = nlohmann::json::parse(machine::to_json(findings));
  } else {
    for (const machine::Consequence& c : machine::consequences(loaded)) std::printf("%s\n", c.str().c_str());
  }
  int program_errors = 0;
  if (machine_errors == 0) {
    // The origins and tools in force, where the machine has been used; a damaged state is the running
    // control's matter.
    const program::Tables tables =
        machine::StateDirectory(loaded.machine.resolve(loaded.machine.run.state)).load().state.tables;
    for (const std::string& name : options.programs) {
      ProgramFile program;
      if (const int code = open_program(loaded.machine, name, options.dialect, program); code != kDone)
        return code;
      program::CheckReport report = program::check_program(program.dialect, program.model, tables, name,
                                                           program.text, program.loader, {});
      const std::vector<text::Finding>& found = report.findings;
      program_errors += print_findings(found);
      if (options.json) {
        nlohmann::json entry = describe(report, program.model, name);
        entry["findings"] = nlohmann::json::parse(machine::to_json(found));
        json["programs"].push_back(entry);
      } else {
        print_report(report, program.model, name);
      }
    }
  }
  if (options.json) std::printf("%s\n", json.dump(1).c_str());
  return machine_errors + program_errors > 0 ? kAlarm : kDone;
}

}  // namespace servogate::gateway::command
