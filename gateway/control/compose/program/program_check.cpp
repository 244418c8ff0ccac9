// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_check.hpp"

#include <algorithm>
#include <iterator>
#include <variant>

#include "firmware_if/text/units.hpp"
#include "gateway/control/compose/setup/axis_setup.hpp"
#include "kernel/program/faults/texts.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kBySignals{
    "program.by-signals",
    "with all signals off this block gives an error: {0} ({1}); on the machine that is decided when the "
    "block is reached",
    "при всех сигналах, равных нулю, кадр даёт ошибку: {0} ({1}); что будет на станке, покажет выполнение"};
const text::Entry kByPlace{
    "program.by-place",
    "from the present position of the axes this block gives an error: {0} ({1}); from another position it "
    "may not",
    "с нынешнего положения осей кадр даёт ошибку: {0} ({1}); с другого её может не быть"};

const text::Entry kByStart{
    "program.by-start",
    "this program is started by another one, and this block gives an error: {0} ({1}); what the other one "
    "has "
    "changed by then may prevent it",
    "эту программу пускает другая, и кадр даёт ошибку: {0} ({1}); её может не быть из-за того, что к этому "
    "времени изменит другая"};

const text::Entry kTurningModes{
    "program.turning-modes",
    "programs of this machine begin with {0}, as on a lathe, and no axis is programmed in diameter: give "
    "power_on = [\"G94\", \"G97\"] in [control], or write {1} into the program",
    "программы этого станка начинаются с {0}, как на токарном, а осей с диаметром нет: задайте power_on = "
    "[\"G94\", \"G97\"] в [control] или запишите {1} в программу"};
const text::Entry kSlowCorners{
    "program.slow-corners",
    "{0} of {1} blocks end at rest because ERF is 0: about {2} s, with ERF 0.01 about {3} s (variables = { "
    "ERF = 0.01, MCD = 2 } in [control], or (ERF=0.01) in the program)",
    "кадров с остановом в конце из-за ERF = 0: {0} из {1}, около {2} с; при ERF 0.01 около {3} с (variables "
    "= "
    "{ ERF = 0.01, MCD = 2 } в [control] или (ERF=0.01) в программе)"};
constexpr double kUsualError = 0.01, kUsualAngle = 2.0;  ///< ERF in mm and MCD, as the examples have them
constexpr long long kManyStops = 50;

/// What tells whether an error depends on where the axes stand: odd amounts, mm or degrees, that no program
/// knows.
constexpr double kElsewhere[] = {0.0213, -0.0347};

bool is_error(const text::Finding& f) { return f.severity == text::Severity::error; }

bool same(const text::Finding& a, const text::Finding& b) {
  return a.file == b.file && a.line == b.line && a.entry == b.entry && a.arguments == b.arguments;
}

void soften(text::Finding& finding, const text::Entry& why) {
  const std::string words =
      text::both(text::render(*finding.entry, finding.arguments, text::Language::english),
                 text::render(*finding.entry, finding.arguments, text::Language::russian));
  finding.arguments = {words, std::string(finding.entry->id)};
  finding.entry = &why;
  finding.severity = text::Severity::warning;
}

/// What keeps an order to another process from being carried out on any day.
std::optional<text::Finding> not_ordered(const machine::MachineConfig& machine, const ProgramFile& file,
                                         const program::Command& command) {
  using Action = program::ProcessOrder::Action;
  const auto* order = std::get_if<program::ProcessOrder>(&command.what);
  if (order == nullptr || order->action == Action::release) return std::nullopt;
  if (order->process > machine.control.processes)
    return channel::no_such_process(order->process, machine.control.processes);
  if (order->action == Action::start && !file.loader(order->program))
    return channel::program_not_found(order->process, order->program);
  return std::nullopt;
}

}  // namespace

Start start_after_homing(const machine::MachineConfig& machine) {
  Start start;
  start.known = true;
  for (std::size_t a = 0; a < machine.program_axes(); ++a) {
    const machine::HomingConfig& home = machine.axes[a].home;
    if (home.method == machine::HomingMethod::none || home.method == machine::HomingMethod::absolute ||
        !home.final_move)
      start.known = false;
    else
      start.at[a] = home.final_position;
  }
  return start;
}

ProgramCheck check_program(const machine::MachineConfig& machine, const ProgramFile& file,
                           const program::Tables& tables, const Start& start, channel::Forecast::Depth depth,
                           const std::stop_token& stop) {
  const channel::ProcessConfig process = process_config(machine, file.process);
  channel::Forecast forecast(depth, process.path, process.axes, start.at,
                             start.axes.value_or(machine.axes_of_process(file.process)));
  ProgramCheck check;
  check.report = program::check_program(
      file.dialect, file.model, tables, file.path, file.text, file.loader, start.at,
      [&](const program::Command& c) {
        if (stop.stop_requested()) throw Cancelled{};
        const program::CornerRule* corner = nullptr;
        if (const auto* line = std::get_if<program::Line>(&c.what)) corner = &line->corner;
        if (const auto* arc = std::get_if<program::Arc>(&c.what)) corner = &arc->corner;
        if (corner != nullptr) {
          ++check.feed_blocks;
          const bool stops = corner->transition == program::Transition::exact_stop;
          if (stops && check.stops++ == 0 && c.file == 0) check.first_stop = c.line;
        }
        if (auto finding = not_ordered(machine, file, c)) return finding;
        if (const auto* order = std::get_if<program::ProcessOrder>(&c.what);
            order != nullptr && order->action == program::ProcessOrder::Action::start)
          check.starts.emplace(order->process - 1, order->program);
        const std::optional<text::Finding> flaw = forecast.take(c);
        const int axis = forecast.foreign_axis(c);
        return axis < 0
                   ? flaw
                   : std::optional(channel::foreign(file.model.axes[static_cast<std::size_t>(axis)].letter));
      },
      file.process);
  check.motion_s = forecast.motion_seconds();
  check.slowest = forecast.slowest();
  return check;
}

void explain_power_on(const machine::MachineConfig& machine, const ProgramFile& file,
                      std::vector<text::Finding>& findings) {
  const auto no_diameter = [](const auto& axis) { return !axis.diameter; };
  if (!std::all_of(file.model.axes.begin(), file.model.axes.end(), no_diameter)) return;
  const program::Interpreter begins(file.dialect, file.model, {}, {}, {}, {}, {});
  const bool feed = begins.feed_per_revolution(), speed = begins.cutting_speed();
  const text::Entry& of_speed = program::entry(program::Fault::surface_speed_axis);
  const auto follows = [&](const text::Finding& f) {
    return (speed && f.entry == &of_speed) ||
           (feed && f.entry == &program::entry(program::Fault::spindle_stands));
  };
  const auto first = std::find_if(findings.begin(), findings.end(), follows);
  if (!(feed || speed) || first == findings.end()) return;
  findings.erase(std::remove_if(first + 1, findings.end(), follows), findings.end());
  const machine::Where where = machine.where("control.power_on");
  findings.push_back({text::Severity::warning,
                      machine.file,
                      where.line,
                      where.column,
                      &kTurningModes,
                      {feed && speed ? "G95, G96"
                       : feed        ? "G95"
                                     : "G96",
                       feed && speed ? "G94 G97"
                       : feed        ? "G94"
                                     : "G97"},
                      {}});
}

std::optional<text::Finding> slow_corners(const machine::MachineConfig& machine, const ProgramFile& file,
                                          const program::Tables& tables, const Start& start,
                                          const ProgramCheck& timed) {
  if (file.dialect != "nc110" || file.model.variable("ERF", 0.0) > 0.0) return std::nullopt;
  if (timed.stops < kManyStops || 2 * timed.stops < timed.feed_blocks || !timed.report.finished)
    return std::nullopt;
  ProgramFile rounded = file;
  rounded.model.variables["ERF"] = kUsualError;
  rounded.model.variables.try_emplace("MCD", kUsualAngle);
  const ProgramCheck other = check_program(machine, rounded, tables, start, channel::Forecast::Depth::timed);
  const long long because = timed.stops - other.stops;
  if (2 * because < timed.stops) return std::nullopt;
  return text::Finding{text::Severity::warning,
                       file.path,
                       std::max(timed.first_stop, 1),
                       1,
                       &kSlowCorners,
                       {std::to_string(because), std::to_string(timed.feed_blocks),
                        text::number(timed.seconds(), 0), text::number(other.seconds(), 0)},
                       {}};
}

namespace {

ProgramCheck prove_alone(const machine::MachineConfig& machine, const ProgramFile& file,
                         const program::Tables& tables, const Start& start, channel::Forecast::Depth depth,
                         const std::stop_token& stop) {
  ProgramCheck check = check_program(machine, file, tables, start, depth, stop);
  std::vector<text::Finding>& findings = check.report.findings;
  const auto of_run = findings.begin() + static_cast<std::ptrdiff_t>(check.report.of_run);
  if (std::none_of(of_run, findings.end(), is_error)) return check;
  for (const std::size_t f : check.report.by_machine) soften(findings[f], kBySignals);
  if (start.known || std::none_of(of_run, findings.end(), is_error)) return check;
  for (const double away : kElsewhere) {
    Start other = start;
    for (std::size_t a = 0; a < machine.program_axes(); ++a) other.at[a] += away * static_cast<double>(a + 1);
    const ProgramCheck from_there =
        check_program(machine, file, tables, other, channel::Forecast::Depth::drivable, stop);
    for (auto f = of_run; f != findings.end(); ++f)
      if (is_error(*f) && std::none_of(from_there.report.findings.begin(), from_there.report.findings.end(),
                                       [&](const text::Finding& g) { return same(*f, g); }))
        soften(*f, kByPlace);
  }
  return check;
}

}  // namespace

void prove_started(const machine::MachineConfig& machine, const ProgramFile& file,
                   const program::Tables& tables, ProgramCheck& check, const std::stop_token& stop) {
  std::set<std::pair<int, std::string>> seen, ahead = check.starts;
  while (!ahead.empty()) {
    const auto [process, name] = *ahead.begin();
    ahead.erase(ahead.begin());
    if (!seen.emplace(process, name).second) continue;
    auto loaded = file.loader ? file.loader(name) : std::nullopt;
    if (!loaded) continue;
    ProgramFile other;
    other.path = loaded->path.empty() ? name : loaded->path;
    other.dialect = file.dialect;
    other.text = program::ProgramText(std::move(loaded->text));
    other.process = process;
    other.model = program_model(machine, process);
    other.loader = file.loader;
    ProgramCheck its = prove_alone(machine, other, tables, Start{}, channel::Forecast::Depth::drivable, stop);
    // What its run meets may be otherwise by then: it begins with the tables of the one that starts it.
    for (std::size_t f = its.report.of_run; f < its.report.findings.size(); ++f)
      if (is_error(its.report.findings[f])) soften(its.report.findings[f], kByStart);
    std::copy_if(its.report.findings.begin(), its.report.findings.end(),
                 std::back_inserter(check.report.findings), [](const text::Finding& f) {
                   return is_error(f) || f.entry == &kByStart || f.entry == &kByPlace ||
                          f.entry == &kBySignals;
                 });
    ahead.insert(its.starts.begin(), its.starts.end());
  }
}

ProgramCheck prove_program(const machine::MachineConfig& machine, const ProgramFile& file,
                           const program::Tables& tables, const Start& start, channel::Forecast::Depth depth,
                           const std::stop_token& stop) {
  ProgramCheck check = prove_alone(machine, file, tables, start, depth, stop);
  prove_started(machine, file, tables, check, stop);
  return check;
}

}  // namespace servogate::gateway
