// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/status_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "gateway/control/run/words/jog_words.hpp"
#include "machine/consequences.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;

constexpr const char* kModes[] = {"off", "mdi", "auto", "step", "manual", "increment", "profile", "home"};
constexpr const char* kStates[] = {"idle",  "running", "held", "waiting", "stopped_by_alarm",
                                   "ended", "stopped"};
constexpr const char* kOwners[] = {"none", "process", "manual", "homing", "plc", "bench", "gear"};
constexpr const char* kGearStates[] = {"none", "engaging", "in_step", "disengaging", "refused"};
static_assert(std::size(kGearStates) == image::kGearStates);
constexpr const char* kDriveStates[] = {
    "offline",     "not_ready_to_switch_on", "switch_on_disabled", "ready_to_switch_on",
    "switched_on", "operation_enabled",      "quick_stop_active",  "fault_reaction_active",
    "fault"};

/// A measure as people want to read it: to a millionth, without the dust of binary fractions.
double measure(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

json list_of(const std::vector<AlarmRow>& alarms, text::Language language) {
  json list = json::array();
  for (const auto& [a, reaction] : alarms) {
    const image::AlarmRecord& r = a.record;
    list.push_back({{"number", r.number},
                    {"id", a.id},
                    {"text", a.text},
                    {"remedy", a.remedy},
                    {"first", !a.consequence},
                    {"sequence", r.sequence},
                    {"first_fault", r.first_fault},
                    {"time_s", static_cast<double>(r.t_ns) * 1e-9},
                    {"line", r.line},
                    {"reaction", reaction},
                    {"warning", r.reaction <= image::Reaction::warn}});
    if (a.finding)
      list.back()["finding"] =
          json::parse(machine::to_json(std::vector<text::Finding>{*a.finding}, language), nullptr, false)[0];
  }
  return list;
}

json json_of(const WaitWords& w) {
  json out{{"reason", w.reason}, {"text", w.text},       {"remedy", w.remedy}, {"file", w.file},
           {"line", w.line},     {"since_s", w.since_s}, {"for_s", w.for_s}};
  const auto add = [&](const char* key, std::string_view words) {
    if (!words.empty()) out[key] = words;
  };
  add("place", w.place);
  add("symbol", w.symbol);
  add("written_by", w.written_by);
  add("axis", w.axis);
  add("word", w.word);
  if (w.wanted) {
    out["compare"] = w.compare;
    out["wanted"] = *w.wanted;
    out["actual"] = *w.actual;
  }
  return out;
}

json json_of(const ProcessReport& p) {
  json stop;
  if (p.stop) stop = {{"cause", p.stop->cause}, {"text", p.stop->text}, {"remedy", p.stop->remedy}};
  return {{"mode", kModes[static_cast<int>(p.status.mode)]},
          {"state", kStates[static_cast<int>(p.status.state)]},
          {"program", p.program},
          {"blocks", p.blocks},
          {"lines", p.lines},
          {"block", p.block ? json(*p.block) : json()},
          {"stop", stop},
          {"line", p.status.line},
          {"file", p.file},
          {"text", p.text},
          {"corrector", p.corrector},
          {"rotation_deg", measure(p.rotation_deg)},
          {"blocks_done", p.status.blocks_done},
          {"message", p.message},
          {"wait", p.wait ? json_of(*p.wait) : json()},
          {"feed_mm_min", measure(p.status.feed_mm_s * 60.0)},
          {"override_pct", measure(p.status.override_ratio * 100.0)},
          {"retraced_mm", p.status.retraced ? json(measure(p.status.retraced_mm)) : json()},
          {"retracing", p.status.retracing},
          {"holds_later", p.status.holds_later},
          {"off_spindle_mm", p.status.by_spindle ? json(measure(p.status.off_spindle_mm)) : json()},
          {"tap_overshoot_mm", measure(p.status.tap_overshoot_mm)},
          {"path_wheel", p.status.wheel.chosen ? json{{"pct", measure(p.status.wheel.rate() * 100.0)},
                                                      {"lost", p.status.wheel.lost}}
                                               : json()},
          {"touched", p.touched ? json{{"axis", p.touched->axis}, {"places", p.touched->places}} : json()},
          {"tool", p.status.tool}};
}

json json_of(const AxisReport& r) {
  const image::AxisImage& a = r.axis;
  json end;
  if (a.jog_end != image::JogEnd::none)
    end = {{"reason", jog_end_name(a.jog_end)}, {"code", jog_end_code(a.jog_end)}, {"text", r.jog_end}};
  json gear;
  if (!r.gear_master.empty())
    gear = {{"number", a.gear.number},
            {"master", r.gear_master},
            {"state", kGearStates[static_cast<int>(a.gear.state)]},
            {"phase_error", measure(a.gear.phase_error)},
            {"refusal", r.gear_refusal.empty() ? json() : json(r.gear_refusal)}};
  return {{"letter", r.letter},
          {"unit", r.unit},
          {"diameter", r.diameter},
          {"auxiliary", r.auxiliary},
          {"process", r.auxiliary ? json() : json(a.process + 1)},
          {"command", measure(r.command)},
          {"position", measure(r.position)},
          {"work", r.axis.process < 0 || r.auxiliary ? json() : json(measure(r.work))},
          {"to_go", measure(r.to_go)},
          {"beside", measure(r.beside)},
          {"origin", r.origin < 0 ? json() : json(r.origin)},
          {"following_error", measure(a.following_error)},
          {"enabled", a.enabled},
          {"homed", a.homed},
          {"moving", a.moving},
          {"in_position", a.in_position},
          {"owner", kOwners[static_cast<int>(a.owner)]},
          {"jog_end", end},
          {"gear", gear},
          {"drive", kDriveStates[static_cast<int>(a.drive.state)]},
          {"on_limit", a.limit_plus    ? 1
                       : a.limit_minus ? -1
                                       : 0}};
}

json json_of(const SpindleReport& r) {
  constexpr const char* kSuppliers[] = {"drive", "inverter", "outputs"};
  const bool outputs = r.supplier == SpindleSupplier::outputs;
  return {{"supplier", kSuppliers[static_cast<int>(r.supplier)]},
          {"place", r.place},
          {"running", r.spindle.running},
          {"command_rpm", measure(r.spindle.command_rpm)},
          {"actual_rpm", measure(r.spindle.actual_rpm)},
          {"angle_deg", measure(r.spindle.angle_deg)},
          {"at_speed", r.spindle.at_speed},
          {"axis", r.axis.empty() ? json() : json(r.axis)},
          {"phase_error_deg", r.spindle.coupled ? json(measure(r.spindle.phase_error_deg)) : json()},
          {"rests", r.rests ? json(*r.rests) : json()},
          {"gear", !r.gears ? json() : json(r.gear)},
          {"drive", outputs ? json() : json(kDriveStates[static_cast<int>(r.spindle.drive.state)])}};
}

/// `nmt_state` is that of CiA 301: 4, 5, 127; null: nothing is heard of the node.
json json_of(const std::vector<BusReport>& buses) {
  json list = json::array();
  for (const BusReport& bus : buses) {
    json nodes = json::array();
    for (const BusNodeReport& n : bus.nodes)
      nodes.push_back(
          {{"node", n.node},
           {"name", n.name},
           {"online", n.told.online},
           {"nmt_state",
            n.told.nmt_state == image::BusNodeStatus::kSilent ? json() : json(n.told.nmt_state)}});
    list.push_back({{"name", bus.name}, {"url", bus.url}, {"place", bus.place}, {"nodes", std::move(nodes)}});
  }
  return list;
}

constexpr const char* kQualities[] = {"never", "good", "stale", "bad"};

json json_of(const std::vector<ChipReport>& chips) {
  json list = json::array();
  for (const ChipReport& c : chips)
    list.push_back({{"station", c.station},
                    {"url", c.url},
                    {"quality", kQualities[static_cast<int>(c.health.quality)]},
                    {"errors", c.health.errors}});
  return list;
}

json json_of(const ModbusUnitReport& u) {
  const bool known = u.health.quality != image::Quality::never;
  return {{"station", u.station},
          {"unit", u.unit},
          {"quality", kQualities[static_cast<int>(u.health.quality)]},
          {"age_s", known ? json(measure(u.age_s)) : json()},
          {"errors", u.health.errors}};
}

json json_of(const std::vector<ModbusLineReport>& lines) {
  json list = json::array();
  for (const ModbusLineReport& line : lines) {
    json l = {{"name", line.name}, {"url", line.url}, {"units", json::array()}, {"counters", json()}};
    for (const ModbusUnitReport& u : line.units) l["units"].push_back(json_of(u));
    if (line.counters)
      l["counters"] = {
          {"requests", line.counters->requests},     {"repeats", line.counters->repeats},
          {"timeouts", line.counters->timeouts()},   {"wrong_answers", line.counters->wrong()},
          {"exceptions", line.counters->exceptions}, {"broken", line.counters->of(modbus::Heard::broken)},
          {"openings", line.counters->openings},     {"failed_openings", line.counters->failed_openings}};
    list.push_back(std::move(l));
  }
  return list;
}

}  // namespace

json json_of(const std::vector<MissingCondition>& missing) {
  json list = json::array();
  for (const MissingCondition& c : missing)
    list.push_back({{"reason", c.reason}, {"text", c.text}, {"remedy", c.remedy}, {"axes", c.axes}});
  return list;
}

json json_of(const std::vector<ForcedValue>& forced) {
  json list = json::array();
  for (const ForcedValue& f : forced)
    list.push_back({{"name", f.name}, {"value", f.value}, {"user", f.user}, {"stays", f.stays}});
  return list;
}

void write(json& answer, const StatusReport& s) {
  answer.update({{"schema", 1},
                 {"machine", s.machine},
                 {"time_s", measure(s.time_s)},
                 {"homing", s.homing},
                 {"homing_left", s.homing_left},
                 {"ending", s.ending},
                 {"processes", json::array()},
                 {"spindles", json::array()}});
  for (std::size_t p = 0; p < s.processes.size(); ++p) {
    json process = json_of(s.processes[p]);
    if (p == 0) answer.update(process);
    process["process"] = p + 1;
    answer["processes"].push_back(std::move(process));
  }
  for (const AxisReport& a : s.axes) answer["axes"].push_back(json_of(a));
  for (const SpindleReport& r : s.spindles) answer["spindles"].push_back(json_of(r));
  answer["buses"] = json_of(s.buses);
  answer["modbus"] = json_of(s.modbus);
  answer["chips"] = json_of(s.chips);
  answer["alarms"] = list_of(s.alarms, s.language);
  answer["missing"] = json_of(s.missing);
  answer["works"] = json::array();
  for (const WorkReport& w : s.works)
    answer["works"].push_back({{"what", w.what}, {"name", w.name}, {"for_s", measure(w.for_s)}});
  answer["forced"] = json_of(s.forced);
  answer["plc_held_by"] = s.plc_held_by.empty() ? json() : json(s.plc_held_by);
}

void write(json& answer, const AlarmReport& report) {
  answer["schema"] = 1;
  answer["alarms"] = list_of(report.alarms, report.language);
  for (const WaitWords& wait : report.waits) answer["waits"].push_back(json_of(wait));
}

void write(json& answer, const HistoryReport& report) {
  json events = json::array();
  for (const history::Event& e : report.events)
    events.push_back({{"time", e.time},
                      {"machine_s", measure(e.machine_s)},
                      {"kind", e.kind},
                      {"id", e.id},
                      {"number", e.number},
                      {"who", e.who},
                      {"text", e.text(report.language)}});
  answer.update({{"schema", 1},
                 {"events", events},
                 {"problem", report.problem.empty() ? json() : json(report.problem)}});
}

void write(json& answer, const HeldBuses& held) {
  json lines = json::array();
  for (const LineReport& line : held.lines)
    lines.push_back({{"name", line.name}, {"url", line.url}, {"place", line.place}});
  answer.update({{"schema", 1},
                 {"kind", held.run ? "run" : "control"},
                 {"machine", held.machine},
                 {"buses", json_of(held.buses)},
                 {"lines", std::move(lines)}});
}

}  // namespace servogate::gateway
