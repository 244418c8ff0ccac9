// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "gateway/control/server/protocol/caller.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "gateway/control/server/resident/request_desk.hpp"

namespace servogate::gateway {

/// Which question of which client.
struct Ticket {
  std::uint64_t client = 0;    ///< counts from 1; 0: nobody waits
  std::uint64_t question = 0;  ///< the client's own number
};

/// A request on its way to the machine.
struct Question {
  Ticket ticket;
  ask::Command command;
  Caller caller;
  Stops asked_at;  ///< when it came

  Asked asked() const { return {asked_at, caller.since, caller.gone}; }
};

}  // namespace servogate::gateway
