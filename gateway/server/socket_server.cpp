// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/socket_server.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"
#include "gateway/server/request/request_form.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

using nlohmann::json;

namespace {

constexpr int kLookAtShutDown_ms = 20;
constexpr int kLookAtAnswers_ms = 1;

}  // namespace

SocketServer::SocketServer(Resident& resident, std::string path)
    : LineServer(std::move(path)),
      resident_(resident),
      shut_down_(resident.control(), resident.requests()),
      urgent_(resident.control(), resident.requests(), resident.speed()),
      desk_(resident, [this](const Ticket& ticket, Reply answer) { reply(ticket, std::move(answer)); }) {}

SocketServer::~SocketServer() { stop(); }

void SocketServer::start() {
  desk_.start();
  LineServer::start();
}

void SocketServer::shut_down() noexcept {
  shuts_down_ = true;
  wake();
}

std::optional<Reply> SocketServer::answer(std::string_view line, Connection& connection,
                                          const Ticket& ticket) {
  FormProblem problem;
  std::optional<json> request = read_request(line, problem);
  if (!request) return refuse(*problem.entry, problem.arguments, kWrongUse, problem.language);
  Caller caller;
  caller.connection = connection.number;
  caller.user = connection.user;
  if (!read_caller(*request, caller, problem))
    return refuse(*problem.entry, problem.arguments, kWrongUse, problem.language);
  if (!is_urgent(*request)) {
    desk_.take({ticket, std::move(*request), std::move(caller), resident_.requests().stops()});
    return std::nullopt;
  }
  if (request->value("cmd", "") != "down")
    return urgent_.take(*request, caller, connection, ticket, resident_.ending());
  resident_.set_ending();  // nothing begins behind the answer
  Reply reply = accept(says::kDown, {}, caller.language, json::object());
  reply.down = true;
  return reply;
}

bool SocketServer::urgent(std::string_view line) const {
  FormProblem problem;
  const std::optional<json> request = read_request(line, problem);
  return request && is_urgent(*request);
}

void SocketServer::leaves(const Reply& reply, Connection* connection) {
  if (reply.down) down_ = true;
  if (reply.jog) urgent_.begin(*reply.jog, connection);
}

void SocketServer::let_go(Connection& connection) {
  urgent_.let_go(connection);
  desk_.gone(connection.number);
}

void SocketServer::watch(Connection& connection) { urgent_.watch(connection); }

int SocketServer::look_after_ms(bool jogs) const {
  int after = shuts_down_ || down_ ? kLookAtShutDown_ms : LineServer::look_after_ms(jogs);
  if (jogs) after = std::min(after, UrgentDesk::kLookAtJogs_ms);
  return urgent_.waits() ? kLookAtAnswers_ms : after;
}

void SocketServer::look() {
  urgent_.look([this](const Ticket& ticket, Reply answer) { reply(ticket, std::move(answer)); });
  if (!shuts_down_ || at_rest_) return;
  if (!resident_.ending()) resident_.set_ending();
  desk_.cancel();
  at_rest_ = shut_down_.look();
}

void SocketServer::ended() {
  at_rest_ = true;
  desk_.stop();
}

}  // namespace servogate::gateway
