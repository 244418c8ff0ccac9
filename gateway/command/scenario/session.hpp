// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::gateway::command {

/// `servogate test --session`: a machine in virtual time that another program steps by lines of JSON on
/// standard input, each answered by one on standard output (docs/testing.md). The exit code.
int session(const std::string& machine_file);

}  // namespace servogate::gateway::command
