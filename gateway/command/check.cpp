// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "firmware_if/text/units.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/program_option.hpp"
#include "gateway/control/compose/devices/open_devices.hpp"
#include "gateway/control/compose/open_bus.hpp"
#include "gateway/control/compose/plc/logic_options.hpp"
#include "gateway/control/compose/program/program_check.hpp"
#include "machine/consequences.hpp"
#include "machine/files/read_file.hpp"
#include "plc/run/run.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kTravelLine{"check.extent", "{0}: {1} to {2} of {3} to {4} {5}",
                              "{0}: от {1} до {2} при ходе от {3} до {4} {5}"};
const text::Entry kTravelLineDiameter{"check.extent-diameter", "{0} (diameter): {1} to {2} of {3} to {4} {5}",
                                      "{0} (диаметр): от {1} до {2} при ходе от {3} до {4} {5}"};
const text::Entry kTurnsLine{"check.extent-endless", "{0}: {1} to {2} {3}, without end",
                             "{0}: от {1} до {2} {3}, ось без ограничения хода"};
const text::Entry kTimeLine{
    "check.time",
    "{0}: {1} blocks, about {2} s: {3} s of motion ({4} mm at feed), {5} s of dwells; the PLC adds its "
    "own for {6} M, S and T",
    "{0}: кадров {1}, около {2} с: движение {3} с ({4} мм на подаче), выдержки {5} с; сверх того время "
    "ПЛК на функции M, S и T ({6})"};
const text::Entry kSlowHead{
    "check.slow-head", "where most time is lost (mm/min):", "где теряется больше всего времени (мм/мин):"};
const text::Entry kSlowLine{"check.slow", "{0}: {1} of F{2}, {3} s lost: {4}",
                            "{0}: {1} при F{2}, потеря {3} с: {4}"};
const text::Entry kSlowTimes{"check.slow-times", "{0}, {1} times", "{0}, раз: {1}"};
const text::Entry kSlowBlock{"check.slow-line", "line {0}", "строка {0}"};
const text::Entry kSlowSubprogram{"check.slow-subprogram", "line {0} of a subprogram",
                                  "строка {0} подпрограммы"};
const text::Entry kSlowBlocks{"check.slow-lines", "lines {0} to {1}", "строки {0}–{1}"};
/// Index = path::Brake; {0} the axis.
const text::Entry kBrakes[] = {
    {"check.slow-rest", "it rests there", "там останов"},
    {"check.slow-velocity", "velocity of {0}", "скорость {0}"},
    {"check.slow-acceleration", "acceleration of {0}", "ускорение {0}"},
    {"check.slow-jerk", "jerk of {0}", "рывок {0}"},
    {"check.slow-shape", "corners in the tolerance", "углы в пределах допуска"},
};
constexpr const char* kBrakeNames[] = {"rest", "velocity", "acceleration", "jerk", "shape"};
const text::Entry kToolLine{"check.tool", "tool {0} corrector {1}, first in line {2}, called {3} times",
                            "инструмент {0}, корректор {1}, впервые в строке {2}, вызовов: {3}"};
const text::Entry kNoLogic{
    "check.no-logic",
    "[plc] names no sources: only a PLC program gives enables and acknowledgements, so that nothing can be "
    "switched on and no program can start; examples/minimal has the least that does",
    "в [plc] нет исходных текстов: разрешения и подтверждения даёт только программа ПЛК, поэтому ничего не "
    "включится и программа не начнётся; наименьшая — в examples/minimal"};
const text::Entry kSummary{"check.summary", "{0}, {1}", "{0}, {1}"};

constexpr double kEndless = 1e9;  ///< MachineModel's travel of an axis without end is larger

std::string sentence(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

void check_logic(const machine::MachineConfig& machine, std::vector<text::Finding>& findings) {
  std::vector<plc::SourceFile> sources;
  for (const std::string& name : machine.plc.sources) {
    std::string reason;
    auto content = files::read_file(machine.resolve(name), files::kMostOfSource, reason);
    if (!content) {
      findings.push_back({text::Severity::error, machine.resolve(name), 1, 1, &kCannotRead, {reason}});
      return;
    }
    sources.push_back({machine.resolve(name), std::move(*content)});
  }
  if (sources.empty()) {
    const machine::Where where = machine.where("plc");
    if (!machine.axes.empty())
      findings.push_back({text::Severity::error, machine.file, where.line, where.column, &kNoLogic, {}, {}});
    return;
  }
  std::vector<text::Finding> of_logic;
  plc::check(sources, machine.symbol_table(), logic_options(machine), of_logic);
  findings.insert(findings.end(), of_logic.begin(), of_logic.end());
}

/// The axis of a limit; the axes of a path are the first of the machine.
std::string letter_of(const path::SlowPlace& place, const program::MachineModel& model) {
  return place.axis < 0 ? std::string() : model.axes[static_cast<std::size_t>(place.axis)].letter;
}

nlohmann::json json_of(const path::SlowPlace& place, const program::MachineModel& model) {
  return {{"line", place.first.line},
          {"file", place.first.file},
          {"to_line", place.last.line},
          {"times", place.times},
          {"seconds", place.seconds},
          {"lost_s", place.lost},
          {"slowest_mm_min", 60.0 * place.slowest},
          {"feed_mm_min", 60.0 * place.feed},
          {"limit", kBrakeNames[static_cast<std::size_t>(place.brake)]},
          {"axis", place.axis < 0 ? nlohmann::json() : nlohmann::json(letter_of(place, model))}};
}

nlohmann::json describe(const ProgramCheck& check, const program::MachineModel& model,
                        const std::string& name) {
  const program::CheckReport& report = check.report;
  nlohmann::json json{{"program", name},
                      {"finished", report.finished},
                      {"blocks", report.blocks},
                      {"executed", report.executed},
                      {"time_s", check.seconds()},
                      {"motion_s", check.motion_s},
                      {"dwell_s", report.dwell_seconds},
                      {"functions", report.functions},
                      {"path_mm", report.path_mm}};
  for (std::size_t a = 0; a < report.extents.size(); ++a)
    json["extents"][model.axes[a].letter] = {{"min", report.extents[a].min},
                                             {"max", report.extents[a].max},
                                             {"travel_min", report.extents[a].travel_min},
                                             {"travel_max", report.extents[a].travel_max},
                                             {"outside_line", report.extents[a].outside_line}};
  json["slowest"] = nlohmann::json::array();
  for (const path::SlowPlace& place : check.slowest) json["slowest"].push_back(json_of(place, model));
  json["tools"] = nlohmann::json::array();
  for (const auto& t : report.tools)
    json["tools"].push_back(
        {{"number", t.number}, {"corrector", t.corrector}, {"line", t.line}, {"calls", t.calls}});
  return json;
}

/// Of a feed in mm/min: none, and the first two digits of one below 10.
int decimals_of(double feed) {
  constexpr int kMost = 4;
  int decimals = 0;
  for (double least = 10.0; decimals < kMost && feed < least; least /= 10.0) ++decimals;
  return decimals;
}

/// The table of the slowest places.
void print_slowest(const ProgramCheck& check, const program::MachineModel& model) {
  if (check.slowest.empty()) return;
  print_line("  " + sentence(kSlowHead, {}));
  for (const path::SlowPlace& place : check.slowest) {
    const std::string first = std::to_string(place.first.line), last = std::to_string(place.last.line);
    const bool one = place.first.line == place.last.line || place.first.file != place.last.file;
    std::string where = place.first.file != 0 ? sentence(kSlowSubprogram, {first})
                        : one                 ? sentence(kSlowBlock, {first})
                                              : sentence(kSlowBlocks, {first, last});
    const int decimals = decimals_of(60.0 * place.feed);
    if (place.times > 1) where = sentence(kSlowTimes, {where, std::to_string(place.times)});
    print_line("    " +
               sentence(kSlowLine, {where, text::number(60.0 * place.slowest, decimals),
                                    text::number(60.0 * place.feed, decimals), text::number(place.lost, 2),
                                    sentence(kBrakes[static_cast<std::size_t>(place.brake)],
                                             {letter_of(place, model)})}));
  }
}

void print_report(const ProgramCheck& check, const program::MachineModel& model, const std::string& name) {
  const program::CheckReport& report = check.report;
  print_line(sentence(kTimeLine, {name, std::to_string(report.blocks), text::number(check.seconds(), 1),
                                  text::number(check.motion_s, 1), text::number(report.path_mm, 1),
                                  text::number(report.dwell_seconds, 1), std::to_string(report.functions)}));
  for (std::size_t a = 0; a < report.extents.size(); ++a) {
    const auto& e = report.extents[a];
    if (!e.moved) continue;
    const program::MachineModel::Axis& axis = model.axes[a];
    const auto place = [&](double v) { return text::number(axis.diameter ? 2.0 * v : v, 3); };
    const std::string unit = text::unit_words(axis.rotary ? "deg" : "mm");
    if (e.travel_max - e.travel_min >= kEndless) {
      print_line("  " + sentence(kTurnsLine, {axis.letter, place(e.min), place(e.max), unit}));
      continue;
    }
    print_line("  " + sentence(axis.diameter ? kTravelLineDiameter : kTravelLine,
                               {axis.letter, place(e.min), place(e.max), place(e.travel_min),
                                place(e.travel_max), unit}));
  }
  for (const auto& t : report.tools)
    print_line("  " + sentence(kToolLine, {std::to_string(t.number), std::to_string(t.corrector),
                                           std::to_string(t.line), std::to_string(t.calls)}));
  print_slowest(check, model);
}

/// As people go through a program: the files in the order of their first finding, each from its top.
void order_by_place(std::vector<text::Finding>& found) {
  std::map<std::string, std::size_t> file;
  for (const text::Finding& f : found) file.emplace(f.file, file.size());
  std::stable_sort(found.begin(), found.end(), [&](const text::Finding& a, const text::Finding& b) {
    return std::tuple(file[a.file], a.line, a.column) < std::tuple(file[b.file], b.line, b.column);
  });
}

int warnings_of(const std::vector<text::Finding>& findings) {
  return static_cast<int>(std::count_if(findings.begin(), findings.end(), [](const text::Finding& f) {
    return f.severity == text::Severity::warning;
  }));
}

/// "no errors", "1 error", "2 errors".
std::string counted(int n, const std::string& english, const std::string& russian) {
  const std::string number = std::to_string(n);
  return text::both((n == 0 ? "no" : number) + " " + english + (n == 1 ? "" : "s"),
                    russian + (n == 0 ? " нет" : ": " + number));
}

/// The last line: what all of it comes to.
void sum_up(int errors, int warnings) {
  print_line(sentence(kSummary,
                      {counted(errors, "error", "ошибок"), counted(warnings, "warning", "предупреждений")}));
}

/// What the programs of a command line came to.
struct ProgramErrors {
  int found = 0, warnings = 0;
  bool unreadable = false;
};

ProgramErrors check_programs(const CheckOptions& options, const machine::MachineConfig& machine,
                             const program::Tables& tables, nlohmann::json& json) {
  ProgramErrors errors;
  for (const std::string& name : options.programs) {
    ProgramFile program;
    program.process = options.process - 1;
    std::vector<text::Finding> found;
    nlohmann::json entry{{"program", name}};
    if (open_program(machine, name, options.dialect, program, found)) {
      ProgramCheck result = check_program(machine, program, tables, start_after_homing(machine),
                                          channel::Forecast::Depth::surveyed);
      prove_started(machine, program, tables, result);
      found.insert(found.end(), result.report.findings.begin(), result.report.findings.end());
      explain_power_on(machine, program, found);
      if (const auto slow = slow_corners(machine, program, tables, start_after_homing(machine), result))
        found.push_back(*slow);
      order_by_place(found);
      errors.found += print_findings(found);
      errors.warnings += warnings_of(found);
      if (options.json)
        entry = describe(result, program.model, name);
      else
        print_report(result, program.model, name);
    } else {
      errors.unreadable = true;
      print_findings(found);
    }
    if (!options.json) continue;
    entry["findings"] = nlohmann::json::parse(machine::to_json(found));
    json["programs"].push_back(entry);
  }
  return errors;
}

}  // namespace

int check(const CheckOptions& options) {
  if (const int code = check_dialect(options.dialect); code != kDone) return code;
  const machine::LoadResult loaded = machine::load(options.machine);
  std::vector<text::Finding> findings = loaded.findings;
  program::Tables tables;
  if (loaded.ok()) {
    check_logic(loaded.machine, findings);
    const bool known = check_devices(loaded, findings);
    if (known && !options.elsewhere) {
      probe_buses(loaded.machine, findings);
      probe_devices(loaded, findings);
    }
    tables = program_tables(loaded.machine, options.tables, findings);
  }
  if (loaded.ok())
    if (const int code = check_process(loaded.machine, options.process); code != kDone) return code;
  const int machine_errors = print_findings(findings);
  nlohmann::json json;
  if (options.json) {
    json["schema"] = 1;
    json["machine"] = nlohmann::json::parse(machine::to_json(loaded, machine::consequences(loaded)));
    json["findings"] = nlohmann::json::parse(machine::to_json(findings));
  } else {
    for (const machine::Consequence& c : machine::consequences(loaded)) print_line(c.str());
  }
  ProgramErrors programs;
  if (machine_errors == 0) programs = check_programs(options, loaded.machine, tables, json);
  if (options.json) print_exact(json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  if (!loaded.readable || programs.unreadable) return kWrongUse;
  if (!options.json) sum_up(machine_errors + programs.found, warnings_of(findings) + programs.warnings);
  return machine_errors + programs.found > 0 ? kAlarm : kDone;
}

}  // namespace servogate::gateway::command
