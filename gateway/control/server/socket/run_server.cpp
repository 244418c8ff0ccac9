// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/socket/run_server.hpp"

#include <algorithm>

#include "gateway/control/server/desk/dispatch/bus_reading.hpp"
#include "gateway/control/server/desk/dispatch/status.hpp"
#include "gateway/control/server/protocol/reply_json.hpp"
#include "gateway/control/server/protocol/request_form.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

bool RunServer::needed(const machine::MachineConfig& machine) {
  const auto outside = [](const auto& part) { return !part.mock(); };
  return std::ranges::any_of(machine.buses, outside) || std::ranges::any_of(machine.stations, outside);
}

std::optional<std::string> RunServer::answer(std::string_view line, Connection&, const LinePlace&) {
  FormProblem problem;
  const std::optional<ReadRequest> request = read_request(line, problem);
  if (!request) return line_of(refuse(*problem.entry, problem.arguments, kWrongUse, problem.language));
  if (ask::is_any<ask::Buses>(request->command)) {
    control_.cycle().read(image_);
    Reply reply;
    reply.content = held_buses(control_.machine(), image_, true);
    return line_of(reply);
  }
  if (const auto* wanted = std::get_if<ask::SdoRead>(&request->command))
    return line_of(sdo_read(control_, *wanted, request->language));
  return line_of(refuse(says::kOnlyRead, {request->name}, kWrongUse, request->language));
}

}  // namespace servogate::gateway
