// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/run_server.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"
#include "gateway/server/bus_reading.hpp"
#include "gateway/server/request/request_form.hpp"
#include "gateway/server/status.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

using nlohmann::json;

bool RunServer::needed(const machine::MachineConfig& machine) {
  return std::any_of(machine.buses.begin(), machine.buses.end(), [](const auto& b) { return !b.mock(); });
}

std::optional<Reply> RunServer::answer(std::string_view line, Connection&, const Ticket&) {
  FormProblem problem;
  const std::optional<json> request = read_request(line, problem);
  if (!request) return refuse(*problem.entry, problem.arguments, kWrongUse, problem.language);
  const text::Language language = language_of(*request);
  const std::string command = request->value("cmd", "");
  if (command == "buses") {
    control_.cycle().read(image_);
    return Reply{held_buses_json(control_.machine(), image_, true)};
  }
  if (command == "sdo_read") return sdo_read(control_, *request, language);
  return refuse(says::kOnlyRead, {command}, kWrongUse, language);
}

}  // namespace servogate::gateway
