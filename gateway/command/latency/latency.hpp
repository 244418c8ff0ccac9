// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/cli/latency_options.hpp"

namespace servogate::gateway::command {

/// `servogate latency`; its exit code.
int latency(const LatencyOptions& options);

}  // namespace servogate::gateway::command
