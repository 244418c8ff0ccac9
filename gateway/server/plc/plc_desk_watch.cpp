// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>

#include "gateway/compose/plc/force_plan.hpp"
#include "gateway/server/plc/plc_answers.hpp"
#include "gateway/server/plc/plc_desk.hpp"
#include "gateway/server/plc/plc_view.hpp"
#include "gateway/server/resident.hpp"
#include "gateway/server/words/texts.hpp"
#include "plc/lookup.hpp"
#include "plc/types/direct_place.hpp"
#include "plc/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;
using plc_answers::kNoVariable;
using plc_answers::refused;
using text::Entry;

constexpr int kScanPatience_ms = 2000;

const Entry kNoBody{"plc.no-body", "there is no program or instance '{0}'",
                    "программы или экземпляра «{0}» нет"};
const Entry kTooManyNames{"plc.names", "at most {0} names at a time", "не более {0} имён за раз"};

/// What stands at a place that the program has no variable for, as JSON: numbers by the type of the place,
/// `%MW8` as a bit string, characters as a STRING. nullopt: the name is no place of this machine's packets.
std::optional<std::string> place_text(const machine::MachineConfig& m, const plc::TypeTable& types,
                                      const image::Packets& packets, const std::string& name) {
  const auto direct = plc::direct_place(name);
  const auto place = place_of(m, nullptr, name);
  if (!place || !packets.contains(*place)) return std::nullopt;
  if (const plc::Type* type = number_type(types, place->format); type != nullptr && !direct) {
    std::uint8_t bytes[8] = {};
    plc::from_number(*type, packets.number(*place), bytes);
    return plc::to_json(*type, bytes);
  }
  const std::uint8_t* at = packets.data(place->packet) + place->byte();
  if (place->format == image::Format::bl) return packets.bit(*place) ? "true" : "false";
  if (place->format != image::Format::ch) {
    return plc::to_json(*bit_string_type(types, place->format), at);
  }
  plc::Type text;
  text.kind = plc::Kind::string;
  const std::size_t length = std::min<std::size_t>(place->bytes(), plc::kMaxStringCapacity);
  std::vector<std::uint8_t> bytes(1 + length);
  std::copy(at, at + length, bytes.begin() + 1);
  bytes[0] = static_cast<std::uint8_t>(std::find(bytes.begin() + 1, bytes.end(), 0) - bytes.begin() - 1);
  return plc::to_json(text, bytes.data());
}

}  // namespace

/// What forces it: by this name, by another one of the same variable, or of a place that it shares.
const PlcDesk::Force* PlcDesk::force_of(const std::string& name) const {
  const machine::MachineConfig& machine = resident_.control().machine();
  const auto& engine = resident_.control().logic()->program()->engine;
  const std::optional<image::Place> place = place_of(machine, &engine, name);
  const auto mine = engine.find(name);
  for (const Force& f : forces_) {
    if (plc::same_name(f.name, name)) return &f;
    const auto other = place_of(machine, &engine, f.name);
    const auto handle = engine.find(f.name);
    const bool same_place = place && other && place->overlaps(*other);
    if (same_place || (mine && handle && mine->address == handle->address && mine->bit == handle->bit))
      return &f;
  }
  return nullptr;
}

/// A packet place that is forced: what the packet holds, whatever the PLC has written.
std::optional<std::string> PlcDesk::forced_value(const std::string& name, const plc::Type& type) const {
  const Force* const force = force_of(name);
  const std::optional<image::Place> place =
      place_of(resident_.control().machine(), &resident_.control().logic()->program()->engine, name);
  if (force == nullptr || force->places.empty() || !place || place->format == image::Format::ch ||
      place->bytes() != type.size)
    return std::nullopt;
  const image::Packets& packets = resident_.image().packets;
  std::array<std::uint8_t, 8> bytes{};
  if (place->format == image::Format::bl)
    bytes[0] = packets.bit(*place) ? 1 : 0;
  else
    std::memcpy(bytes.data(), packets.data(place->packet) + place->byte(), place->bytes());
  return plc::to_json(type, bytes.data());
}

json PlcDesk::watch(const json& request, const Caller& who) {
  if (request.contains("body")) return watch_body(request.value("body", ""), who);
  constexpr std::size_t kMostNames = 500;
  PlcLogic& logic = *resident_.control().logic();
  const std::shared_ptr<const LogicProgram> program = logic.program();
  const plc::Image& image = program->engine.image();
  const auto names = request.value("names", std::vector<std::string>{});
  if (names.size() > kMostNames)
    return refused(kTooManyNames, {std::to_string(kMostNames)}, kWrongUse, who.language);
  LogicSample sample;
  sample.profile = request.value("times", false);
  std::vector<std::optional<plc::Handle>> handles;
  for (const std::string& name : names) {
    handles.push_back(program->engine.find(name));
    if (handles.back()) {
      sample.ranges.push_back({handles.back()->address, handles.back()->type->size});
    } else if (!place_text(resident_.control().machine(), *image.types, resident_.image().packets, name)) {
      return refused(kNoVariable, {name}, kWrongUse, who.language);
    }
  }
  if (!logic.look(sample, kScanPatience_ms))
    return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
  const image::ProcessImage& now = resident_.image();
  json values = json::array();
  std::size_t at = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string text;
    if (handles[i]) {
      text =
          forced_value(names[i], *handles[i]->type)
              .value_or(plc::value_text(image, *handles[i]->type, sample.bytes.data() + at, handles[i]->bit));
      at += handles[i]->type->size;
    } else {
      text = place_text(resident_.control().machine(), *image.types, now.packets, names[i]).value_or("null");
    }
    values.push_back({{"name", names[i]}, {"value", json::parse(text, nullptr, false)}});
    if (const Force* f = force_of(names[i])) values.back()["forced"] = f->value;
  }
  json answer{{"ok", true},
              {"exit", kDone},
              {"schema", 1},
              {"cycle", sample.at.number},
              {"time_s", sample.at.seconds()},
              {"values", values},
              {"forced", forced()}};
  if (!sample.profile) return answer;
  const auto row = [](const std::string& name, const plc::Times& t) {
    const double count = t.count > 0 ? static_cast<double>(t.count) : 1.0;
    return json{{"name", name},
                {"last_us", static_cast<double>(t.last) * 1e-3},
                {"average_us", static_cast<double>(t.sum) * 1e-3 / count},
                {"most_us", static_cast<double>(t.most) * 1e-3},
                {"count", t.count}};
  };
  answer["tasks"] = answer["blocks"] = json::array();
  for (std::size_t i = 0; i < sample.tasks.size(); ++i)
    answer["tasks"].push_back(row(image.tasks[i].name, sample.tasks[i]));
  for (std::size_t i = 0; i < sample.blocks.size(); ++i)
    if (sample.blocks[i].count > 0) answer["blocks"].push_back(row(image.units[i].name, sample.blocks[i]));
  return answer;
}

json PlcDesk::watch_body(const std::string& name, const Caller& who) {
  PlcLogic& logic = *resident_.control().logic();
  const std::shared_ptr<const LogicProgram> program = logic.program();
  const std::vector<std::string> programs = program_names(program->engine.image());
  const std::string wanted = name.empty() && !programs.empty() ? programs.front() : name;
  const WatchedBody body = watched_body(*program, wanted);
  if (body.lines.empty()) return refused(kNoBody, {wanted}, kWrongUse, who.language);
  LogicSample sample;
  for (const WatchedLine& line : body.lines)
    for (const WatchedValue& v : line.values) sample.ranges.push_back({v.address, v.type->size});
  if (!logic.look(sample, kScanPatience_ms))
    return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
  std::size_t at = 0;
  json lines = json::array();
  for (const WatchedLine& line : body.lines) {
    json values = json::array();
    for (const WatchedValue& v : line.values) {
      // Members of the body go without its name.
      const std::string full = program->engine.find(v.name) ? v.name : wanted + "." + v.name;
      const std::string text =
          forced_value(full, *v.type)
              .value_or(plc::value_text(program->engine.image(), *v.type, sample.bytes.data() + at));
      values.push_back({{"name", v.name}, {"value", json::parse(text, nullptr, false)}});
      if (const Force* f = force_of(full)) values.back()["forced"] = f->value;
      at += v.type->size;
    }
    lines.push_back({{"line", line.line}, {"text", line.text}, {"values", values}});
  }
  return {{"ok", true},
          {"exit", kDone},
          {"schema", 1},
          {"cycle", sample.at.number},
          {"time_s", sample.at.seconds()},
          {"body", wanted},
          {"file", body.file},
          {"lines", lines},
          {"forced", forced()}};
}

json PlcDesk::list(const json&, const Caller&) {
  const std::shared_ptr<const LogicProgram> program = resident_.control().logic()->program();
  json files = json::array();
  for (const plc::SourceFile& f : program->sources) files.push_back(f.name);
  json symbols = list_symbols(program->engine.image());
  for (json& s : symbols)
    if (const Force* f = force_of(s.value("name", ""))) s["forced"] = f->value;
  return {{"ok", true},     {"exit", kDone},      {"schema", 1},
          {"files", files}, {"symbols", symbols}, {"forced", forced()}};
}

}  // namespace servogate::gateway
