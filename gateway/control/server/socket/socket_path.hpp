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
/// Socket of a `servogate run` of this process: other names than those of resident controls, so that clients
/// do not take it for one.
std::string run_socket(const std::string& machine_name);
/// Whatever lies in socket_folder() was put there by this user: it is his directory, no link, and nobody else
/// writes into it (a folder in /tmp can be anybody's). True also when it is missing.
bool own_socket_folder();
/// Sockets of resident controls in socket_folder(); none where that is not own_socket_folder(). Those that
/// nobody listens on any more are removed.
std::vector<std::string> known_sockets();
/// The same of runs.
std::vector<std::string> known_runs();
/// Makes the way free for a new socket: the folder exists (socket_folder() is made, 0700 and ours; no other
/// one), nobody listens there, a stale socket file is removed. Empty: done; otherwise what stands against it.
std::string clear_way(const std::string& path, text::Language language = text::user_language());

}  // namespace servogate::gateway
