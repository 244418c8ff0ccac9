// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/socket/socket_server.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/server/dispatch.hpp"
#include "gateway/server/texts.hpp"

namespace servogate::gateway {

namespace {

constexpr int kLookAtShutDown_ms = 20;

}  // namespace

SocketServer::SocketServer(Resident& resident, std::string path)
    : LineServer(std::move(path)), resident_(resident), shut_down_(resident) {}

SocketServer::~SocketServer() { stop(); }

Reply SocketServer::answer(std::string_view line, Connection& connection) {
  Reply reply = dispatch(resident_, line, connection);
  if (reply.down) down_ = true;
  return reply;
}

void SocketServer::let_go(Connection& connection) { end_connection(resident_, connection); }

void SocketServer::watch(Connection& connection) { watch_jogs(resident_, connection); }

int SocketServer::look_after_ms(bool jogs) const {
  if (jogs) return kLookAtJogs_ms;
  return shuts_down_ || down_ ? kLookAtShutDown_ms : LineServer::look_after_ms(jogs);
}

void SocketServer::look() {
  if (const std::string problem = resident_.look_after(); !problem.empty())
    complain(says::kNotSaved, {problem});
  if (!shuts_down_ || at_rest_) return;
  resident_.set_ending();
  at_rest_ = shut_down_.look();
}

}  // namespace servogate::gateway
