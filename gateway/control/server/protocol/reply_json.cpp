// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/reply_json.hpp"

#include <nlohmann/json.hpp>

#include "firmware_if/text/hex.hpp"
#include "gateway/control/server/protocol/status_json.hpp"
#include "machine/consequences.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;

json json_of(const std::vector<text::Finding>& findings) {
  return json::parse(machine::to_json(findings), nullptr, false);
}

json json_of(const std::vector<PlcValue>& values) {
  json list = json::array();
  for (const PlcValue& v : values) {
    list.push_back({{"name", v.name}, {"value", json::parse(v.value, nullptr, false)}});
    if (v.forced) list.back()["forced"] = *v.forced;
  }
  return list;
}

json json_of(const std::vector<PlcTimes>& rows) {
  json list = json::array();
  for (const PlcTimes& t : rows)
    list.push_back({{"name", t.name},
                    {"last_us", t.last_us},
                    {"average_us", t.average_us},
                    {"most_us", t.most_us},
                    {"count", t.count}});
  return list;
}

json json_of(const std::vector<PlcSymbol>& symbols) {
  json list = json::array();
  for (const PlcSymbol& s : symbols) {
    list.push_back({{"name", s.name},
                    {"type", s.type},
                    {"place", s.place},
                    {"retain", s.retain},
                    {"written", s.written},
                    {"read", s.read}});
    if (s.forced) list.back()["forced"] = *s.forced;
  }
  return list;
}

void write(json&, const std::monostate&) {}
void write(json& answer, const JogBegun& jog) { answer["keep_alive_ms"] = jog.keep_alive_ms; }
void write(json& answer, const JogState& jog) {
  answer["moving"] = jog.moving;
  if (jog.axis.empty()) return;
  answer["axis"] = jog.axis;
  answer["reason"] = jog.reason;
}
void write(json& answer, const Zeroed& zeroed) {
  answer["origin"] = zeroed.origin;
  answer["place"] = zeroed.place;
}
void write(json& answer, const FoundIn& found) { answer["findings"] = json_of(found.findings); }
/// Without what is 0 and need not be said.
void write(json& answer, const TablesReport& report) {
  json axes = json::array(), origins = json::array(), tools = json::array();
  for (const TablesReport::Axis& a : report.axes)
    axes.push_back({{"letter", a.letter}, {"unit", a.unit}, {"diameter", a.diameter}});
  for (const auto& [number, values] : report.tables.origins)
    origins.push_back({{"number", number}, {"values", values}});
  for (const auto& [number, c] : report.tables.correctors)
    tools.push_back({{"number", number},
                     {"name", c.name},
                     {"length", c.length},
                     {"wear", c.wear},
                     {"radius", c.radius},
                     {"radius_wear", c.radius_wear},
                     {"wear_limit", c.wear_limit},
                     {"radius_wear_limit", c.radius_wear_limit},
                     {"quadrant", c.quadrant},
                     {"life_min", c.life_min},
                     {"used_min", c.used_min},
                     {"alternate", c.alternate}});
  answer.update({{"schema", 1}, {"axes", axes}, {"origins", origins}, {"tools", tools}});
}
void write(json& answer, const RestartReport& r) {
  json axes = json::array(), spindle;
  for (const RestartReport::Axis& a : r.axes)
    axes.push_back({{"letter", a.letter}, {"unit", a.unit}, {"stands", a.stands}, {"begins", a.begins}});
  if (r.spindle)
    spindle = {{"direction", r.spindle->mode == program::SpindleMode::ccw ? "ccw" : "cw"},
               {"speed", r.spindle->speed},
               {"surface_speed", r.spindle->surface_speed}};
  answer.update({{"schema", 1},
                 {"line", r.line},
                 {"executed", r.executed},
                 {"file", r.file},
                 {"block_text", r.text},
                 {"tool", r.tool},
                 {"corrector", r.corrector},
                 {"spindle", spindle},
                 {"coolant", r.coolant ? json(*r.coolant) : json()},
                 {"passed", r.passed},
                 {"writes", r.writes},
                 {"signals", r.signals},
                 {"axes", axes},
                 {"steps", r.steps},
                 {"from_disk", r.from_disk},
                 {"overlap_mm", r.overlap_mm ? json(*r.overlap_mm) : json()},
                 {"asked_s", r.asked_s}});
}
void write(json& answer, const ExportedTable& table) { answer["content"] = table.content; }
void write(json& answer, const Begun& begun) { answer["asked_s"] = begun.asked_s; }
void write(json& answer, const FunctionsBegun&) { answer["beside"] = true; }
void write(json& answer, const ObjectRead& object) {
  answer.update({{"status", object.status}, {"abort", object.abort}, {"data", text::hex_bytes(object.data)}});
}
void write(json& answer, const PlcLoaded& loaded) {
  answer["findings"] = json_of(loaded.findings);
  if (!loaded.taken) return;
  answer.update({{"files", loaded.files},
                 {"online", loaded.online},
                 {"kept", loaded.kept},
                 {"fresh", loaded.fresh},
                 {"given_up", loaded.given_up},
                 {"forces_lost", loaded.forces_lost},
                 {"set_aside", loaded.set_aside},
                 {"taken_back", loaded.taken_back},
                 {"lost", loaded.lost}});
}
void write(json& answer, const PlcValues& seen) {
  answer.update({{"schema", 1},
                 {"cycle", seen.cycle},
                 {"time_s", seen.time_s},
                 {"values", json_of(seen.values)},
                 {"forced", json_of(seen.forced)}});
  if (!seen.timed) return;
  answer["tasks"] = json_of(seen.tasks);
  answer["blocks"] = json_of(seen.blocks);
}
void write(json& answer, const PlcBody& body) {
  json lines = json::array();
  for (const PlcBody::Line& line : body.lines)
    lines.push_back({{"line", line.line}, {"text", line.text}, {"values", json_of(line.values)}});
  answer.update({{"schema", 1},
                 {"cycle", body.cycle},
                 {"time_s", body.time_s},
                 {"body", body.body},
                 {"file", body.file},
                 {"lines", lines},
                 {"forced", json_of(body.forced)}});
}
void write(json& answer, const PlcSymbols& list) {
  answer.update({{"schema", 1}, {"files", list.files}, {"symbols", json_of(list.symbols)}});
}

std::string dump(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

std::string line_of(const Reply& reply) {
  json answer{{"ok", reply.ok}, {"exit", reply.exit}};
  if (!reply.code.empty()) answer["code"] = reply.code;
  if (!reply.text.empty()) answer["text"] = reply.text;
  if (reply.missing) answer["missing"] = json_of(*reply.missing);
  std::visit([&](const auto& content) { write(answer, content); }, reply.content);
  if (const auto* list = std::get_if<PlcSymbols>(&reply.content)) answer["forced"] = json_of(list->forced);
  return dump(answer);
}

std::string line_of(const PlcSymbols& symbols) {
  json answer = json::object();
  write(answer, symbols);
  return dump(answer);
}

}  // namespace servogate::gateway
