// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_check.hpp"

#include <algorithm>

#include "gateway/control/compose/setup/axis_setup.hpp"

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
        const std::optional<text::Finding> flaw = forecast.take(c);
        const int axis = forecast.foreign_axis(c);
        return axis < 0
                   ? flaw
                   : std::optional(channel::foreign(file.model.axes[static_cast<std::size_t>(axis)].letter));
      },
      file.process);
  check.motion_s = forecast.motion_seconds();
  return check;
}

ProgramCheck prove_program(const machine::MachineConfig& machine, const ProgramFile& file,
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

}  // namespace servogate::gateway
