// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

/// `servogate touch`: asks, measures, and writes a tool's length or an origin; its exit code.
int touch(const ClientOptions& options);

}  // namespace servogate::gateway::command
