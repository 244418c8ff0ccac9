// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/status.hpp"

#include <nlohmann/json.hpp>

namespace servogate::gateway {

namespace {

using nlohmann::json;

constexpr const char* kModes[] = {"off", "mdi", "auto", "step", "manual", "increment", "profile", "home"};
constexpr const char* kStates[] = {"idle", "running", "held", "waiting", "stopped_by_alarm", "ended"};
constexpr const char* kOwners[] = {"none", "process", "manual", "homing", "plc", "bench"};
constexpr const char* kDriveStates[] = {
    "offline",     "not_ready_to_switch_on", "switch_on_disabled", "ready_to_switch_on",
    "switched_on", "operation_enabled",      "quick_stop_active",  "fault_reaction_active",
    "fault"};

json alarm_list(Resident& resident, text::Language language) {
  const cycle::AlarmNames names = resident.control().alarm_names();
  json list = json::array();
  const cycle::AlarmSnapshot& alarms = resident.alarms();
  for (int i = 0; i < alarms.count; ++i) {
    const image::AlarmRecord& r = alarms.records[static_cast<std::size_t>(i)];
    const cycle::AlarmRow* row = cycle::find_alarm(r.number);
    list.push_back({{"number", r.number},
                    {"id", row != nullptr ? std::string(row->text.id) : std::string()},
                    {"text", cycle::render(r, names, language)},
                    {"remedy", cycle::render_remedy(r, names, language)},
                    {"first", r.first_fault == r.sequence},
                    {"time_s", static_cast<double>(r.t_ns) * 1e-9},
                    {"line", r.line},
                    {"reaction", cycle::words(r.reaction, language)}});
  }
  return list;
}

}  // namespace

std::string status_json(Resident& resident, text::Language language) {
  const image::ProcessImage& image = resident.image();
  const machine::MachineConfig& m = resident.control().machine();
  const image::ProcessStatus& p = image.processes[0];
  bool homing = false;
  for (int i = 0; i < image.axis_count; ++i)
    homing = homing || image.axes[static_cast<std::size_t>(i)].owner == image::AxisOwner::homing;
  json status{{"ok", true},
              {"exit", 0},
              {"schema", 1},
              {"machine", m.name},
              {"time_s", image.now.seconds()},
              {"mode", kModes[static_cast<int>(p.mode)]},
              {"state", kStates[static_cast<int>(p.state)]},
              {"program", resident.program()},
              {"line", p.line},
              {"blocks_done", p.blocks_done},
              {"blocks", resident.blocks()},
              {"homing", homing},
              {"feed_mm_min", p.feed_mm_s * 60.0},
              {"override_pct", p.override_ratio * 100.0},
              {"tool", p.tool}};
  for (int i = 0; i < image.axis_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const image::AxisImage& a = image.axes[n];
    const double shown = m.axes[n].diameter ? 2.0 : 1.0;
    status["axes"].push_back({{"letter", m.axes[n].letter},
                              {"unit", m.axes[n].type == machine::AxisType::rotary ? "deg" : "mm"},
                              {"diameter", m.axes[n].diameter},
                              {"command", a.command * shown},
                              {"position", a.actual * shown},
                              {"following_error", a.following_error},
                              {"enabled", a.enabled},
                              {"homed", a.homed},
                              {"moving", a.moving},
                              {"owner", kOwners[static_cast<int>(a.owner)]},
                              {"drive", kDriveStates[static_cast<int>(a.drive.state)]},
                              {"on_limit", a.limit_plus    ? 1
                                           : a.limit_minus ? -1
                                                           : 0}});
  }
  for (int i = 0; i < image.spindle_count; ++i) {
    const image::SpindleImage& s = image.spindles[static_cast<std::size_t>(i)];
    status["spindles"].push_back({{"command_rpm", s.command_rpm},
                                  {"actual_rpm", s.actual_rpm},
                                  {"at_speed", s.at_speed},
                                  {"drive", kDriveStates[static_cast<int>(s.drive.state)]}});
  }
  status["alarms"] = alarm_list(resident, language);
  return status.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string alarms_in_words(Resident& resident, text::Language language) {
  const cycle::AlarmNames names = resident.control().alarm_names();
  const cycle::AlarmSnapshot& alarms = resident.alarms();
  std::string words;
  for (int i = 0; i < alarms.count; ++i) {
    const image::AlarmRecord& r = alarms.records[static_cast<std::size_t>(i)];
    words += (words.empty() ? "" : "; ") + std::to_string(r.number) + " " + cycle::render(r, names, language);
  }
  return words;
}

std::string alarms_json(Resident& resident, text::Language language) {
  return json{{"ok", true}, {"exit", 0}, {"schema", 1}, {"alarms", alarm_list(resident, language)}}.dump(
      -1, ' ', false, json::error_handler_t::replace);
}

}  // namespace servogate::gateway
