// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/drive/measurement/loop_response.hpp"

/// Frequency responses as the record of a run and people have them. Not real-time safe.
namespace servogate::gateway::command {

/// [{"hz", "db", "deg", "coherence"}].
nlohmann::json lines_json(const bench::FrequencyResponse& response);
/// "figures", "closed_loop" and "open_loop" of a record.
void put_loop_response(const bench::LoopResponse& response, const std::string& loop, nlohmann::json& meta);
void say_loop_response(const bench::LoopResponse& response);

}  // namespace servogate::gateway::command
