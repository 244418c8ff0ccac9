// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/status.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "gateway/machine/bus_place.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/run/standstill.hpp"
#include "gateway/run/words/alarm_entries.hpp"
#include "gateway/run/words/jog_words.hpp"
#include "gateway/run/words/ready_words.hpp"
#include "gateway/run/words/stop_words.hpp"
#include "gateway/run/words/wait_words.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;

constexpr const char* kModes[] = {"off", "mdi", "auto", "step", "manual", "increment", "profile", "home"};
constexpr const char* kStates[] = {"idle",  "running", "held", "waiting", "stopped_by_alarm",
                                   "ended", "stopped"};
constexpr std::string_view kTypedFile = "MDI";  ///< what the interpreter calls the file of typed blocks
constexpr const char* kOwners[] = {"none", "process", "manual", "homing", "plc", "bench"};
constexpr const char* kDriveStates[] = {
    "offline",     "not_ready_to_switch_on", "switch_on_disabled", "ready_to_switch_on",
    "switched_on", "operation_enabled",      "quick_stop_active",  "fault_reaction_active",
    "fault"};

/// A measure as people want to read it: to a millionth, without the dust of binary fractions.
double measure(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

json finding_json(const text::Finding& finding, text::Language language) {
  return json::parse(machine::to_json(std::vector<text::Finding>{finding}, language), nullptr, false)[0];
}

json alarm_list(Resident& resident, text::Language language) {
  const cycle::AlarmSnapshot& alarms = resident.alarms();
  const std::span records(alarms.records.data(), static_cast<std::size_t>(alarms.count));
  json list = json::array();
  for (const report::AlarmEntry& a : alarm_entries(resident.control(), records, language)) {
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
                    {"reaction", cycle::words(r.reaction, language)},
                    {"warning", r.reaction <= image::Reaction::warn}});
    if (a.finding) list.back()["finding"] = finding_json(*a.finding, language);
  }
  return list;
}

json wait_json(const std::optional<WaitWords>& wait) {
  if (!wait) return nullptr;
  const WaitWords& w = *wait;
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

json stop_json(const std::optional<StopWords>& stop) {
  if (!stop) return nullptr;
  return {{"cause", stop->cause}, {"text", stop->text}, {"remedy", stop->remedy}};
}

json jog_end_json(image::JogEnd end, const std::string& axis, text::Language language) {
  if (end == image::JogEnd::none) return nullptr;
  return {{"reason", jog_end_name(end)},
          {"code", jog_end_code(end)},
          {"text", jog_end_words(end, axis, language)}};
}

/// File of the block in motion; a typed block is in none, but what it calls is.
std::string file_in_motion(Control& control, const image::ProcessStatus& p, int process) {
  const std::string file = control.process(process).texts().file(p.run, p.file);
  return p.typed && file == kTypedFile ? std::string() : file;
}

/// What `status` says of one process.
json process_json(Resident& resident, const image::ProcessImage& image, int process,
                  text::Language language) {
  Control& control = resident.control();
  const image::ProcessStatus& p = image.processes[static_cast<std::size_t>(process)];
  return {{"mode", kModes[static_cast<int>(p.mode)]},
          {"state", kStates[static_cast<int>(p.state)]},
          {"block", p.typed ? json(resident.manual_block()) : json()},
          {"stop", stop_json(stop_words(control, image, process, language))},
          {"line", p.line},
          {"file", p.line > 0 ? file_in_motion(control, p, process) : ""},
          {"blocks_done", p.blocks_done},
          {"message", program_message(control, image, process)},
          {"wait", wait_json(wait_words(control, image, process, language))},
          {"feed_mm_min", measure(p.feed_mm_s * 60.0)},
          {"override_pct", measure(p.override_ratio * 100.0)},
          {"tool", p.tool}};
}

/// The buses of a machine: `name`, `url`, `place` (bus_place()), `nodes` with `online` (configured, and its
/// process data come) and `nmt_state` (CiA 301: 4, 5, 127; null: nothing is heard of it).
json buses_json(const machine::MachineConfig& m, const image::ProcessImage& image) {
  json buses = json::array();
  const auto state = [](std::uint8_t nmt) {
    return nmt == image::BusNodeStatus::kSilent ? json() : json(nmt);
  };
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const machine::BusConfig& bus = m.buses[b];
    json nodes = json::array();
    for (const machine::NodeConfig& node : bus.nodes) {
      const image::BusNodeStatus& told = image.segments[b].nodes[static_cast<std::size_t>(node.id)];
      nodes.push_back({{"node", node.id},
                       {"name", node.name},
                       {"online", told.online},
                       {"nmt_state", state(told.nmt_state)}});
    }
    buses.push_back({{"name", bus.name},
                     {"url", bus.url},
                     {"place", machine::bus_place(bus.url)},
                     {"nodes", std::move(nodes)}});
  }
  return buses;
}

/// What clients wait for that takes long.
json works_json(Resident& resident) {
  json works = json::array();
  const auto now = std::chrono::steady_clock::now();
  for (const Works::Entry& w : resident.works().list())
    works.push_back({{"what", w.what},
                     {"name", w.name},
                     {"for_s", measure(std::chrono::duration<double>(now - w.since).count())}});
  return works;
}

}  // namespace

std::string held_buses_json(const machine::MachineConfig& machine, const image::ProcessImage& image,
                            bool run) {
  const json held{{"ok", true},
                  {"exit", 0},
                  {"schema", 1},
                  {"kind", run ? "run" : "control"},
                  {"machine", machine.name},
                  {"buses", buses_json(machine, image)}};
  return held.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string status_json(Resident& resident, text::Language language) {
  const image::ProcessImage& image = resident.image();
  const machine::MachineConfig& m = resident.control().machine();
  bool homing = image.homing;
  for (int i = 0; i < image.axis_count; ++i)
    homing = homing || image.axes[static_cast<std::size_t>(i)].owner == image::AxisOwner::homing;
  json status{{"ok", true},
              {"exit", 0},
              {"schema", 1},
              {"machine", m.name},
              {"time_s", measure(image.now.seconds())},
              {"program", resident.program()},
              {"blocks", resident.blocks()},
              {"lines", resident.lines()},
              {"homing", homing},
              {"homing_left", json::array()},
              {"ending", resident.ending()},
              {"processes", json::array()},
              {"spindles", json::array()}};
  for (int p = 0; p < image.process_count; ++p) {
    json process = process_json(resident, image, p, language);
    if (p == 0) status.update(process);
    process["process"] = p + 1;
    status["processes"].push_back(std::move(process));
  }
  for (int i = 0; i < image.axis_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const image::AxisImage& a = image.axes[n];
    const double shown = m.axes[n].diameter ? 2.0 : 1.0;
    if ((image.homing_left >> i & 1u) != 0) status["homing_left"].push_back(m.axes[n].letter);
    status["axes"].push_back({{"letter", m.axes[n].letter},
                              {"unit", m.axes[n].unit()},
                              {"diameter", m.axes[n].diameter},
                              {"auxiliary", m.axes[n].auxiliary},
                              {"command", measure(a.command * shown)},
                              {"position", measure(a.actual * shown)},
                              {"following_error", measure(a.following_error)},
                              {"enabled", a.enabled},
                              {"homed", a.homed},
                              {"moving", a.moving},
                              {"in_position", a.in_position},
                              {"owner", kOwners[static_cast<int>(a.owner)]},
                              {"jog_end", jog_end_json(a.jog_end, m.axes[n].letter, language)},
                              {"drive", kDriveStates[static_cast<int>(a.drive.state)]},
                              {"on_limit", a.limit_plus    ? 1
                                           : a.limit_minus ? -1
                                                           : 0}});
  }
  for (int i = 0; i < image.spindle_count; ++i) {
    const image::SpindleImage& s = image.spindles[static_cast<std::size_t>(i)];
    status["spindles"].push_back(
        {{"command_rpm", measure(s.command_rpm)},
         {"actual_rpm", measure(s.actual_rpm)},
         {"at_speed", s.at_speed},
         {"rests", spindle_lost(image, m, i) ? json() : json(spindle_rests(image, i))},
         {"drive", kDriveStates[static_cast<int>(s.drive.state)]}});
  }
  status["buses"] = buses_json(m, image);
  status["alarms"] = alarm_list(resident, language);
  status["missing"] = missing_json(resident, language);
  status["works"] = works_json(resident);
  status["forced"] = resident.plc().forced();
  status["plc_held_by"] = resident.plc().held_by().empty() ? json(nullptr) : json(resident.plc().held_by());
  return status.dump(-1, ' ', false, json::error_handler_t::replace);
}

json missing_json(Resident& resident, text::Language language) {
  json list = json::array();
  const image::ProcessImage& image = resident.image();
  if (static_cast<std::size_t>(image.axis_count) != resident.control().machine().axes.size()) return list;
  for (const MissingCondition& c : missing_for_power(resident.control(), image, resident.alarms(), language))
    list.push_back({{"reason", c.reason}, {"text", c.text}, {"remedy", c.remedy}, {"axes", c.axes}});
  return list;
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

std::string history_json(const history::EventLog* log, std::size_t count, text::Language language) {
  json events = json::array();
  for (const history::Event& e : log == nullptr ? std::vector<history::Event>() : log->last(count))
    events.push_back({{"time", e.time},
                      {"machine_s", measure(e.machine_s)},
                      {"kind", e.kind},
                      {"id", e.id},
                      {"number", e.number},
                      {"who", e.who},
                      {"text", e.text(language)}});
  json answer{{"ok", true}, {"exit", 0}, {"schema", 1}, {"events", events}, {"problem", nullptr}};
  if (log != nullptr && !log->problem().empty()) answer["problem"] = log->problem();
  return answer.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string alarms_json(Resident& resident, text::Language language) {
  const image::ProcessImage& image = resident.image();
  json answer{{"ok", true}, {"exit", 0}, {"schema", 1}, {"alarms", alarm_list(resident, language)}};
  for (int p = 0; p < image.process_count; ++p)
    if (const auto wait = wait_words(resident.control(), image, p, language); wait)
      answer["waits"].push_back(wait_json(wait));
  return answer.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace servogate::gateway
