// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "gateway/server/resident.hpp"

namespace servogate::gateway {

/// State of a running control as one JSON object: modes, program, axes, spindles, first alarm.
std::string status_json(Resident& resident, text::Language language);
/// Active alarms with cause and remedy as one JSON object.
/// The last `count` events of the history, oldest first.
std::string history_json(const history::EventLog* log, std::size_t count, text::Language language);
std::string alarms_json(Resident& resident, text::Language language);
/// Who holds which buses, with their nodes, as one JSON object; `run`: it is a `servogate run`.
std::string held_buses_json(const machine::MachineConfig& machine, const image::ProcessImage& image,
                            bool run);
/// What keeps the drives from being on: a list of `reason`, `text`, `remedy`, `axes`; empty: they are on.
nlohmann::json missing_json(Resident& resident, text::Language language);
/// The alarms in a few words: "alarm 201 X: ...; alarm ...". Empty: none.
std::string alarms_in_words(Resident& resident, text::Language language);

}  // namespace servogate::gateway
