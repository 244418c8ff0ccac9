// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/connection.hpp"

#include <cstdlib>
#include <vector>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/control/server/socket/socket_path.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kNoControl{
    "client.no-control",
    "no control is running (no socket in {0}); start one with `servogate up MACHINE.toml`",
    "управление не запущено (нет сокета в {0}); запуск: `servogate up MACHINE.toml`"};
const text::Entry kForeignFolder{
    "client.foreign-folder",
    "the folder {0} belongs to someone else or others may write into it, so the socket in it cannot be "
    "trusted; remove the folder, or choose a socket with --socket",
    "каталог {0} чужой, или в него могут писать другие, поэтому сокету в нём нельзя доверять; удалите "
    "каталог или укажите сокет ключом --socket"};
const text::Entry kManyControls{"client.many-controls",
                                "several controls are running; choose one with --socket: {0}",
                                "запущено несколько управлений; выберите одно через --socket: {0}"};
const text::Entry kNoConnection{"client.no-connection", "cannot reach the control at {0}: {1}",
                                "нет связи с управлением {0}: {1}"};
const text::Entry kConnectionLost{"client.connection-lost", "the control at {0} closed the connection",
                                  "управление {0} закрыло соединение"};

int find_socket(const std::string& socket, std::string& path) {
  if (!socket.empty()) {
    path = socket;
    return kDone;
  }
  if (const char* named = std::getenv("SERVOGATE_SOCKET"); named != nullptr && *named != '\0') {
    path = named;
    return kDone;
  }
  if (!own_socket_folder()) {
    complain(kForeignFolder, {socket_folder()});
    return kInfrastructure;
  }
  const std::vector<std::string> found = known_sockets();
  if (found.empty()) {
    complain(kNoControl, {socket_folder()});
    return kInfrastructure;
  }
  if (found.size() > 1) {
    std::string list;
    for (const std::string& f : found) list += (list.empty() ? "" : ", ") + f;
    complain(kManyControls, {list});
    return kWrongUse;
  }
  path = found.front();
  return kDone;
}

}  // namespace

int connect_to_control(const std::string& socket, SocketClient& client, std::string& path) {
  if (const int code = find_socket(socket, path); code != kDone) return code;
  const std::string problem = client.connect(path);
  if (problem.empty()) return kDone;
  complain(kNoConnection, {path, problem});
  return kInfrastructure;
}

int connection_lost(const std::string& path) {
  complain(kConnectionLost, {path});
  return kInfrastructure;
}

}  // namespace servogate::gateway::command
