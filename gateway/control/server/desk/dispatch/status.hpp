// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/protocol/status_report.hpp"
#include "gateway/control/server/resident/resident.hpp"

namespace servogate::gateway {

/// State of a running control.
StatusReport status_report(Resident& resident, const PlcDesk& plc, text::Language language);
/// Active alarms with cause and remedy.
AlarmReport alarm_report(Resident& resident, text::Language language);
/// The last `count` events of the history.
HistoryReport history_report(const history::EventLog* log, std::size_t count, text::Language language);
/// Who holds which buses, with their nodes; `run`: it is a `servogate run`.
HeldBuses held_buses(const machine::MachineConfig& machine, const image::ProcessImage& image, bool run);
/// What keeps the drives from being on; empty: they are on.
std::vector<MissingCondition> missing_now(Resident& resident, text::Language language);
/// The alarms in a few words: "alarm 201 X: ...; alarm ...". Empty: none.
std::string alarms_in_words(Resident& resident, text::Language language);

}  // namespace servogate::gateway
