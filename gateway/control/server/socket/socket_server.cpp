// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/socket/socket_server.hpp"

#include "gateway/control/server/protocol/reply_json.hpp"
#include "gateway/control/server/protocol/request_form.hpp"

namespace servogate::gateway {

std::optional<std::string> SocketServer::answer(std::string_view line, Connection& connection,
                                                const LinePlace& place) {
  FormProblem problem;
  std::optional<ReadRequest> request = read_request(line, problem);
  if (!request) return line_of(refuse(*problem.entry, problem.arguments, kWrongUse, problem.language));
  if (connection.client == 0)
    connection.client = desk_.open([this, number = place.connection](std::uint64_t question, Reply answer) {
      reply({number, question}, line_of(answer));
    });
  if (ask::is_urgent(request->command)) connection.urgent_line = place.line;
  desk_.ask(connection.client, place.line, std::move(request->command),
            {.asker = request->asker,
             .user = connection.user,
             .language = request->language,
             .since = connection.since,
             .left = connection.ended,
             .gone = nullptr});
  return std::nullopt;
}

bool SocketServer::urgent(std::string_view line) const {
  FormProblem problem;
  const std::optional<ReadRequest> request = read_request(line, problem);
  return request && ask::is_urgent(request->command);
}

void SocketServer::let_go(Connection& connection) {
  if (connection.client != 0) desk_.close(connection.client);
}

}  // namespace servogate::gateway
