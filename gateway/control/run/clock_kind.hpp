// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::gateway {

/// How time passes.
enum class ClockKind { unset, virtual_time, realtime, realtime_best_effort };

}  // namespace servogate::gateway
