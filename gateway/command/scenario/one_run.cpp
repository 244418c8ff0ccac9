// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/one_run.hpp"

#include <filesystem>

#include "firmware_if/text/in_both.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/scenario/desk_operator.hpp"
#include "report/html.hpp"
#include "report/report.hpp"

namespace servogate::gateway::command {

namespace {

using scenario::Outcome;

const text::Entry kReal{"test.real", "{0} has real buses or devices: a scenario moves them only with --real",
                        "у {0} настоящие шины или устройства: сценарий двигает их только с --real"};
const text::Entry kNoClock{"test.no_clock", "the machine cannot run: {0}", "станок не запустить: {0}"};

constexpr image::Nanoseconds kLongestEnd = 20 * image::kSecond;  ///< until all is off, of machine time

bool any_error(const std::vector<text::Finding>& findings) {
  for (const text::Finding& f : findings)
    if (f.severity == text::Severity::error) return true;
  return false;
}

/// Stops what moves and switches off what is on: a real machine, or drives in other processes, go on living.
void put_to_rest(RunningMachine& machine, DeskOperator& who) {
  const std::function<bool()> step = [&] { return machine.step(); };
  who.ask(ask::Command(ask::Stop{}), text::user_language(), step);
  const auto rests = [&](auto&& moves) {
    const image::ProcessImage& image = machine.image();
    for (int a = 0; a < image.axis_count; ++a)
      if (moves(image.axes[static_cast<std::size_t>(a)])) return false;
    return true;
  };
  const image::Nanoseconds end = machine.image().now.t_ns + kLongestEnd;
  const auto until = [&](auto&& moves) {
    while (!rests(moves) && machine.image().now.t_ns < end && machine.step()) who.poll(step);
  };
  until([](const image::AxisImage& a) { return a.moving; });
  who.ask(ask::Command(ask::Power{false}), text::user_language(), step);
  until([](const image::AxisImage& a) { return a.enabled; });
}

void write_outputs(RunningMachine& machine, Session& session, const Outputs& outputs,
                   const std::string& title) {
  machine.close_files();
  report::Report report = session.make_report(0.0, machine.overruns());
  report::fill_host(report.provenance);
  report.provenance.machine = report::identify(machine.machine().file);
  if (!outputs.report.empty()) report::write_file(outputs.report, report::to_json(report));
  if (outputs.html.empty() || session.picture() == nullptr) return;
  report::HtmlOptions html;
  html.title = title;
  html.language = text::user_language();
  report::write_file(outputs.html, report::to_html(report, *session.picture(), html));
}

}  // namespace

Outcome run_one(const scenario::Scenario& scenario, const TestOptions& options, const Outputs& outputs) {
  Outcome outcome;
  if (!scenario.skip.empty()) return {.status = Outcome::Status::skipped, .message = scenario.skip};
  const machine::LoadResult loaded = machine::load(scenario.machine);
  const auto impossible = [&](std::vector<text::Finding> findings) {
    outcome.status = Outcome::Status::impossible;
    outcome.findings = std::move(findings);
    return outcome;
  };
  const auto infrastructure = [&](std::string message) {
    outcome.status = Outcome::Status::infrastructure;
    outcome.message = std::move(message);
    return outcome;
  };
  if (any_error(loaded.findings)) return impossible(loaded.findings);
  drivers::Notice refusal;
  const ClockKind clock = clock_of(loaded.machine, options.clock, refusal);
  if (clock == ClockKind::unset)
    return infrastructure(
        text::in_both(kNoClock, {text::render(*refusal.entry, refusal.arguments, text::user_language())}));
  if (!loaded.machine.nothing_real() && !options.real)
    return infrastructure(text::in_both(kReal, {scenario.machine}));
  std::vector<text::Finding> findings;
  const auto machine = RunningMachine::compose(loaded, nullptr, {.clock = clock}, findings);
  if (machine == nullptr) {
    if (!Control::infrastructure(findings)) return impossible(std::move(findings));
    return infrastructure(findings.empty() ? std::string() : findings.back().str());
  }
  DeskOperator who(*machine);
  const scenario::Signals signals(machine->machine(), machine->control().symbols(), &who.variables());
  const bool shown = !outputs.trace.empty() || !outputs.html.empty() || !outputs.report.empty();
  Session* const session = shown ? &machine->watch(outputs) : nullptr;
  std::vector<drivers::Notice> refusals;
  if (!machine->begin(refusals))
    return infrastructure(refusals.empty() ? std::string()
                                           : text::render(*refusals.back().entry, refusals.back().arguments,
                                                          text::user_language()));
  outcome = scenario::run(scenario, *machine, who, signals, {.without_faults = options.without_faults});
  if (machine->moves_by_itself() || !loaded.machine.nothing_real()) put_to_rest(*machine, who);
  machine->stop();
  if (session != nullptr) write_outputs(*machine, *session, outputs, scenario.name);
  return outcome;
}

}  // namespace servogate::gateway::command
