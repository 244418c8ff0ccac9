// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/outputs.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

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

}  // namespace servogate::gateway::command
