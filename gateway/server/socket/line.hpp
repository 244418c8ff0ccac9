// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// Which line of which connection.
struct Ticket {
  std::uint64_t connection = 0, line = 0;  ///< both count from 1; connection 0: nobody waits
};

/// A continuous jog that a client keeps alive.
struct HeldJog {
  int axis = 0;
  image::Hand hand;                               ///< that holds it
  std::chrono::steady_clock::time_point heard{};  ///< when that client last kept it alive
  std::chrono::steady_clock::time_point told{};   ///< when the cycle was last told so
  bool silent = false;                            ///< it was ended because its client had fallen silent
};

/// What a line on the control socket leads to.
struct Reply {
  std::string line;                 ///< one JSON object without a line end
  bool down = false;                ///< the control is to end
  std::optional<HeldJog> jog = {};  ///< that was begun
};

/// What the server remembers of a connection.
struct Connection {
  std::vector<HeldJog> jogs;      ///< one an axis at most
  std::uint64_t number = 0;       ///< of this connection; what it forces at the PLC ends with it
  std::string user;               ///< name of who opened it
  std::uint64_t urgent_line = 0;  ///< that is being answered; what stands behind it waits. 0: none
};

/// JSON as a line; what is no UTF-8 is replaced.
std::string text_of(const nlohmann::json& value);
/// An accepted request as a line; `more` is added to it.
Reply accept(const text::Entry& entry, const std::vector<std::string>& arguments, text::Language language,
             nlohmann::json more);
/// A refusal as a line.
Reply refuse(const text::Entry& entry, const std::vector<std::string>& arguments, int exit,
             text::Language language);

}  // namespace servogate::gateway
