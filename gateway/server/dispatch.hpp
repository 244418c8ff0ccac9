// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/server/resident.hpp"

namespace servogate::gateway {

/// What a line on the control socket leads to.
struct Reply {
  std::string line;   ///< one JSON object without a line end
  bool down = false;  ///< the control is to end
};

/// What the server remembers of a connection.
struct Connection {
  int jogs = -1;  ///< axis of the continuous jog that this client keeps alive, -1: none
  image::Asker asker = image::Asker::command_line;  ///< who began it
  bool silent = false;                              ///< it was ended because its client had fallen silent
  std::chrono::steady_clock::time_point heard{};    ///< when that client last kept it alive
  std::uint64_t number = 0;  ///< of this connection; what it forces at the PLC ends with it
  std::string user;          ///< name of who opened it
};

/// Carries out one line of the control socket's protocol (docs/control-socket.md): a JSON object
/// `{"cmd":"jog","asker":"command_line","axis":"X","value":1.0}`; the answer is `{"ok":true,...}` or
/// `{"ok":false,"code":"...","text":"..."}` with an exit code under "exit". Never throws on bad input.
Reply dispatch(Resident& resident, std::string_view line, Connection& connection);

/// The client is gone: what only its keep-alive permitted ends now.
void end_connection(Resident& resident, Connection& connection);

/// To be called now and then, at most kLookAtJogs_ms apart while a client jogs: ends a jog whose client has
/// been silent for 100 ms of the wall clock. In real time and virtual time at its pace the cycle itself
/// judges by its own time; where time is scaled the machine's seconds say nothing of a living hand.
void watch_jog(Resident& resident, Connection& connection);
inline constexpr int kLookAtJogs_ms = 10;

/// A refusal as a line.
Reply refuse(const text::Entry& entry, const std::vector<std::string>& arguments, int exit,
             text::Language language);

}  // namespace servogate::gateway
