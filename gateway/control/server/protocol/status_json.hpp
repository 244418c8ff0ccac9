// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "gateway/control/server/protocol/status_report.hpp"

/// For reply_json.cpp: each adds what it says to the answer.
namespace servogate::gateway {

void write(nlohmann::json& answer, const StatusReport& report);
void write(nlohmann::json& answer, const AlarmReport& report);
void write(nlohmann::json& answer, const HistoryReport& report);
void write(nlohmann::json& answer, const HeldBuses& held);
nlohmann::json json_of(const std::vector<MissingCondition>& missing);
nlohmann::json json_of(const std::vector<ForcedValue>& forced);

}  // namespace servogate::gateway
