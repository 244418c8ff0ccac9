// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <span>
#include <vector>

#include "gateway/control/compose/plc/look.hpp"
#include "gateway/control/server/desk/plc/plc_answers.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/desk/plc/plc_view.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "plc/logic/force_plan.hpp"
#include "plc/types/direct_place.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/places.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::gateway {

namespace {

using plc_answers::kNoVariable;
using text::Entry;

constexpr std::chrono::milliseconds kScanPatience{2000};

const Entry kNoBody{"plc.no-body", "there is no program or instance '{0}'",
                    "программы или экземпляра «{0}» нет"};
const Entry kTooManyNames{"plc.names", "at most {0} names at a time", "не более {0} имён за раз"};

/// What stands at a place that the program has no variable for, as JSON: numbers by the type of the place,
/// `%MW8` as a bit string, characters as a STRING. nullopt: the name is no place of this machine's packets.
std::optional<std::string> place_text(std::span<const image::Symbol> symbols, const plc::TypeTable& types,
                                      const image::Packets& packets, const std::string& name) {
  const auto direct = plc::direct_place(name);
  const auto place = plc::place_of(symbols, name);
  if (!place || !packets.contains(*place)) return std::nullopt;
  if (const plc::Type* type = plc::number_type(types, place->format); type != nullptr && !direct) {
    std::uint8_t bytes[8] = {};
    plc::from_number(*type, packets.number(*place), bytes);
    return plc::to_json(*type, bytes);
  }
  const std::uint8_t* at = packets.data(place->packet) + place->byte();
  if (place->format == image::Format::bl) return packets.bit(*place) ? "true" : "false";
  if (place->format != image::Format::ch) {
    return plc::to_json(*plc::bit_string_type(types, place->format), at);
  }
  plc::Type text;
  text.kind = plc::Kind::string;
  const std::size_t length = std::min<std::size_t>(place->bytes(), plc::kMaxStringCapacity);
  std::vector<std::uint8_t> bytes(1 + length);
  std::copy(at, at + length, bytes.begin() + 1);
  bytes[0] = static_cast<std::uint8_t>(std::find(bytes.begin() + 1, bytes.end(), 0) - bytes.begin() - 1);
  return plc::to_json(text, bytes.data());
}

bool look_at(Resident& resident, plc::LogicSample& sample) {
  plc::Logic& logic = *resident.control().logic();
  const RequestDesk& requests = resident.requests();
  return requests.stepped() ? look(logic, sample, [&] { return requests.pause(); })
                            : look(logic, sample, kScanPatience);
}

}  // namespace

/// What forces it: by this name, by another one of the same variable, or of a place that it shares.
const PlcDesk::Force* PlcDesk::force_of(const std::string& name) const {
  const std::vector<image::Symbol>& symbols = resident_.control().symbols();
  const auto& engine = resident_.control().logic()->program()->engine;
  const std::optional<image::Place> place = plc::place_of(symbols, &engine, name);
  const auto mine = engine.find(name);
  for (const Force& f : forces_) {
    if (plc::same_name(f.name, name)) return &f;
    const auto other = plc::place_of(symbols, &engine, f.name);
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
      plc::place_of(resident_.control().symbols(), &resident_.control().logic()->program()->engine, name);
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

/// A value with what is forced of it. `shown`: name that the answer has; `text`: as the PLC has written it.
PlcValue PlcDesk::value_of(const std::string& shown, const std::string& name, const plc::Type& type,
                           std::string text) const {
  PlcValue value{shown, forced_value(name, type).value_or(std::move(text)), {}};
  if (const Force* f = force_of(name)) value.forced = f->value;
  return value;
}

Outcome PlcDesk::take(const ask::PlcWatch& wanted, const Caller& who) {
  if (wanted.body) return watch_body(*wanted.body, who);
  constexpr std::size_t kMostNames = 500;
  const std::vector<image::Symbol>& symbols = resident_.control().symbols();
  plc::Logic& logic = *resident_.control().logic();
  const std::shared_ptr<const plc::LogicProgram> program = logic.program();
  const plc::Image& image = program->engine.image();
  const std::vector<std::string>& names = wanted.names;
  if (names.size() > kMostNames)
    return refuse(kTooManyNames, {std::to_string(kMostNames)}, kWrongUse, who.language);
  plc::LogicSample sample;
  sample.profile = wanted.times;
  std::vector<std::optional<plc::Handle>> handles;
  for (const std::string& name : names) {
    handles.push_back(program->engine.find(name));
    if (handles.back())
      sample.ranges.push_back({handles.back()->address, handles.back()->type->size});
    else if (!place_text(symbols, *image.types, resident_.image().packets, name))
      return refuse(kNoVariable, {name}, kWrongUse, who.language);
  }
  if (!look_at(resident_, sample)) return refuse(says::kNoAnswer, {}, kInfrastructure, who.language);
  const image::ProcessImage& now = resident_.image();
  PlcValues seen;
  seen.cycle = sample.at.number;
  seen.time_s = sample.at.seconds();
  std::size_t at = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (handles[i]) {
      const plc::Type& type = *handles[i]->type;
      seen.values.push_back(value_of(
          names[i], names[i], type, plc::value_text(image, type, sample.bytes.data() + at, handles[i]->bit)));
      at += type.size;
    } else {
      PlcValue value{names[i], place_text(symbols, *image.types, now.packets, names[i]).value_or("null"), {}};
      if (const Force* f = force_of(names[i])) value.forced = f->value;
      seen.values.push_back(std::move(value));
    }
  }
  seen.forced = forced();
  seen.timed = sample.profile;
  const auto row = [](const std::string& name, const plc::Times& t) {
    const double count = t.count > 0 ? static_cast<double>(t.count) : 1.0;
    return PlcTimes{name, static_cast<double>(t.last) * 1e-3, static_cast<double>(t.sum) * 1e-3 / count,
                    static_cast<double>(t.most) * 1e-3, static_cast<std::uint64_t>(t.count)};
  };
  for (std::size_t i = 0; i < sample.tasks.size(); ++i)
    seen.tasks.push_back(row(image.tasks[i].name, sample.tasks[i]));
  for (std::size_t i = 0; i < sample.blocks.size(); ++i)
    if (sample.blocks[i].count > 0) seen.blocks.push_back(row(image.units[i].name, sample.blocks[i]));
  Reply reply;
  reply.content = std::move(seen);
  return reply;
}

Outcome PlcDesk::watch_body(const std::string& name, const Caller& who) {
  plc::Logic& logic = *resident_.control().logic();
  const std::shared_ptr<const plc::LogicProgram> program = logic.program();
  const std::vector<std::string> programs = program_names(program->engine.image());
  const std::string wanted = name.empty() && !programs.empty() ? programs.front() : name;
  const WatchedBody body = watched_body(*program, wanted);
  if (body.lines.empty()) return refuse(kNoBody, {wanted}, kWrongUse, who.language);
  plc::LogicSample sample;
  for (const WatchedLine& line : body.lines)
    for (const WatchedValue& v : line.values) sample.ranges.push_back({v.address, v.type->size});
  if (!look_at(resident_, sample)) return refuse(says::kNoAnswer, {}, kInfrastructure, who.language);
  PlcBody seen;
  seen.cycle = sample.at.number;
  seen.time_s = sample.at.seconds();
  seen.body = wanted;
  seen.file = body.file;
  seen.forced = forced();
  std::size_t at = 0;
  for (const WatchedLine& line : body.lines) {
    seen.lines.push_back({line.line, line.text, {}});
    for (const WatchedValue& v : line.values) {
      // Members of the body go without its name.
      const std::string full = program->engine.find(v.name) ? v.name : wanted + "." + v.name;
      seen.lines.back().values.push_back(
          value_of(v.name, full, *v.type,
                   plc::value_text(program->engine.image(), *v.type, sample.bytes.data() + at)));
      at += v.type->size;
    }
  }
  Reply reply;
  reply.content = std::move(seen);
  return reply;
}

Outcome PlcDesk::take(const ask::PlcList&, const Caller&) {
  const std::shared_ptr<const plc::LogicProgram> program = resident_.control().logic()->program();
  PlcSymbols list;
  for (const plc::SourceFile& f : program->sources) list.files.push_back(f.name);
  list.symbols = list_symbols(program->engine.image());
  for (PlcSymbol& s : list.symbols)
    if (const Force* f = force_of(s.name)) s.forced = f->value;
  list.forced = forced();
  Reply reply;
  reply.content = std::move(list);
  return reply;
}

}  // namespace servogate::gateway
