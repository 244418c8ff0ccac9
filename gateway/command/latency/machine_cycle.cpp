// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/machine_cycle.hpp"

#include <chrono>
#include <thread>

#include "gateway/cli/messages.hpp"
#include "gateway/command/latency/busy_processors.hpp"
#include "gateway/control/run/running_machine.hpp"

namespace servogate::gateway::command {

std::optional<MachineCycle> measure_machine(const machine::LoadResult& loaded, double seconds, bool load,
                                            const std::function<bool()>& ended) {
  RunSettings settings;
  settings.clock = ClockKind::realtime_best_effort;
  std::vector<text::Finding> findings;
  const auto machine = RunningMachine::compose(loaded, nullptr, settings, findings);
  if (print_findings(findings) > 0 || machine == nullptr) return std::nullopt;
  const Session& session = machine->watch({});
  MachineCycle out;
  const BusyProcessors busy(load);
  if (!machine->begin(out.refusals)) {
    for (const drivers::Notice& n : out.refusals) complain(*n.entry, n.arguments);
    return std::nullopt;
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ended() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  machine->stop();
  out.times = session.times();
  out.overruns = machine->overruns();
  machine->close_files();
  return out;
}

}  // namespace servogate::gateway::command
