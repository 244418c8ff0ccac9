// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// Folder of the control sockets: $XDG_RUNTIME_DIR/servogate, else /tmp/servogate-UID. Its owner's only.
std::string socket_folder();
/// Default socket of a machine by its name (letters, digits and dashes of it).
std::string default_socket(const std::string& machine_name);
/// Sockets of running controls in socket_folder(). Those that nobody listens on any more are removed.
std::vector<std::string> known_sockets();
/// Makes the way free for a new socket: the folder exists (socket_folder() is made, 0700 and ours; no other
/// one), nobody listens there, a stale socket file is removed. Empty: done; otherwise what stands against it.
std::string clear_way(const std::string& path, text::Language language = text::user_language());

}  // namespace servogate::gateway
