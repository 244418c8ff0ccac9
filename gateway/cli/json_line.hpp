// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

namespace servogate::gateway {

/// What a command that goes on says with --json: `object` with "schema": 1 as one line of standard output,
/// written at once. Its "event" names what happened. Bytes that are no UTF-8 are replaced. Not real-time
/// safe.
void print_json_line(nlohmann::json object);

}  // namespace servogate::gateway
