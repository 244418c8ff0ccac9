// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "gateway/server/desk/outcome.hpp"
#include "gateway/server/desk/request_desk.hpp"
#include "gateway/server/request/caller.hpp"

namespace servogate::gateway {

class Resident;

/// A request on its way to the machine.
struct Line {
  Ticket ticket;
  nlohmann::json request;  ///< as read_request() gives it
  Caller caller;
  Stops asked_at;  ///< when it came
};

/// Carries out one request of the control socket's protocol (docs/control-socket.md): a JSON object
/// `{"cmd":"jog","asker":"command_line","axis":"X","value":1.0}`; the answer is `{"ok":true,...}` or
/// `{"ok":false,"code":"...","text":"..."}` with an exit code under "exit". What is_urgent() has a road of
/// its own (UrgentDesk). For the desk's thread. Never throws on bad input.
Outcome dispatch(Resident& resident, const Line& line);

}  // namespace servogate::gateway
