// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "gateway/server/resident.hpp"
#include "gateway/server/socket/line.hpp"

namespace servogate::gateway {

/// Carries out one line of the control socket's protocol (docs/control-socket.md): a JSON object
/// `{"cmd":"jog","asker":"command_line","axis":"X","value":1.0}`; the answer is `{"ok":true,...}` or
/// `{"ok":false,"code":"...","text":"..."}` with an exit code under "exit". Never throws on bad input.
Reply dispatch(Resident& resident, std::string_view line, Connection& connection);

/// The client is gone: what only its keep-alive permitted ends now.
void end_connection(Resident& resident, Connection& connection);

/// To be called now and then, at most kLookAtJogs_ms apart while a client jogs: ends each jog whose client has
/// been silent for 100 ms of the wall clock. In real time and virtual time at its pace the cycle itself
/// judges by its own time; where time is scaled the machine's seconds say nothing of a living hand.
void watch_jogs(Resident& resident, Connection& connection);
inline constexpr int kLookAtJogs_ms = 10;

}  // namespace servogate::gateway
