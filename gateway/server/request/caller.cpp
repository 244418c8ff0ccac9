// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/request/caller.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

using nlohmann::json;

namespace {

constexpr struct {
  std::string_view name;
  image::Asker asker;
} kAskers[] = {{"command_line", image::Asker::command_line},
               {"page", image::Asker::page},
               {"pendant", image::Asker::pendant},
               {"scenario", image::Asker::scenario},
               {"modbus", image::Asker::modbus},
               {"bench", image::Asker::bench}};

constexpr std::string_view kUrgent[] = {"stop", "quick_stop", "hold", "jog_stop", "keep_alive", "down"};

}  // namespace

bool read_caller(const json& request, Caller& caller, FormProblem& problem) {
  caller.language = language_of(request);
  const std::string name = request.value("asker", "command_line");
  std::string known;
  for (const auto& row : kAskers) {
    if (row.name == name) {
      caller.asker = row.asker;
      return true;
    }
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  problem = {&says::kUnknownAsker, {name, known}, caller.language};
  return false;
}

int axis_of(const machine::MachineConfig& machine, const json& name, FormProblem& problem) {
  const std::string letter = name.is_string() ? name.get<std::string>() : "";
  const int index = machine.axis_index(letter);
  if (index >= 0) return index;
  std::string list;
  for (const std::string& l : machine.letters()) list += (list.empty() ? "" : ", ") + l;
  problem.entry = &says::kNoAxis;
  problem.arguments = {letter, list};
  return -1;
}

bool is_urgent(const json& request) {
  const std::string command = request.value("cmd", "");
  if (std::find(std::begin(kUrgent), std::end(kUrgent), command) != std::end(kUrgent)) return true;
  return command == "power" && request.value("value", 1.0) == 0.0;
}

}  // namespace servogate::gateway
