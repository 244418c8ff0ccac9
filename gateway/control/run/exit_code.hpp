// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::gateway {

/// What a command comes to, and what the control's answer to a request comes to: a contract
/// (docs/command-line.md).
enum ExitCode : int { kDone = 0, kAlarm = 1, kWrongUse = 2, kStopped = 3, kInfrastructure = 4 };

}  // namespace servogate::gateway
