// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/machine_cycle.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/command/latency/wake_up.hpp"
#include "gateway/command/machine_start.hpp"
#include "gateway/control/run/exit_code.hpp"
#include "machine/load.hpp"

namespace servogate::gateway::command {
namespace {

const text::Entry kReal{
    "latency.real-machine",
    "{0} has parts that are not simulated: their outputs would be switched while nobody is in command; give "
    "a copy of the "
    "file whose urls are mocks",
    "в {0} есть несимулируемые части: их выходы переключались бы без управляющего; укажите копию файла, "
    "где все адреса — имитации"};
const text::Entry kItsCycle{"latency.cycle-of-machine",
                            "the cycle of a machine is that of its file: leave out --cycle",
                            "цикл станка задан его файлом: уберите --cycle"};

}  // namespace

std::unique_ptr<MachineCycle> measure_machine(const LatencyOptions& options,
                                              const std::function<bool()>& ended, int& code) {
  const LatencyOptions usual;
  code = kWrongUse;
  machine::LoadResult loaded = machine::load(options.bus);
  if (print_findings(loaded.findings) > 0) return nullptr;
  machine::MachineConfig& m = loaded.machine;
  if (!m.nothing_real()) {
    complain(kReal, {options.bus});
    return nullptr;
  }
  if (options.cycle_us != usual.cycle_us) {
    complain(kItsCycle, {});
    return nullptr;
  }
  if (options.priority != usual.priority) m.realtime.priority = options.priority;
  if (options.cpu != usual.cpu) m.realtime.cpu = options.cpu;
  RunSettings settings;
  settings.clock = ClockKind::realtime_best_effort;
  std::vector<text::Finding> findings;
  const auto running = RunningMachine::compose(loaded, nullptr, settings, findings);
  print_findings(findings);
  code = kInfrastructure;
  if (running == nullptr) return nullptr;
  const Session& session = running->watch({});
  const Load load(options.load);
  if (!begin(*running, options.json)) return nullptr;
  const auto until = static_cast<image::Nanoseconds>(options.seconds * 1e9);
  while (!ended() && running->image().now.t_ns < until) running->step();
  running->stop();
  code = ended() ? kStopped : kDone;
  return std::make_unique<MachineCycle>(
      MachineCycle{m.name, static_cast<double>(running->control().cycle().period_ns()) * 1e-3,
                   session.times(), running->overruns()});
}

}  // namespace servogate::gateway::command
