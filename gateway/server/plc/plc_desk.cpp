// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/plc/plc_desk.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/files/read_file.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/report/report.hpp"
#include "gateway/server/plc/plc_view.hpp"
#include "gateway/server/resident.hpp"
#include "gateway/server/texts.hpp"
#include "plc/types/direct_place.hpp"
#include "plc/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;
using text::Entry;

constexpr int kScanPatience_ms = 2000;

const Entry kNoPlc{"plc.none", "this machine has no PLC program", "у этого станка нет программы ПЛК"};
const Entry kNoFiles{"plc.no-files", "cannot read {0}", "не читается {0}"};
const Entry kNotCompiled{"plc.errors", "the PLC program was not changed: it has errors",
                         "программа ПЛК не заменена: в ней есть ошибки"};
const Entry kChanged{"plc.changed", "the PLC runs {0}: {1} values kept, {2} variables begin anew",
                     "ПЛК выполняет {0}: сохранено значений {1}, начато заново переменных {2}"};
const Entry kLoadLater{
    "plc.load-later",
    "Load it when the program has ended and all axes rest; or with --online --while-running, once you have "
    "made sure that the machine may go on with the new logic in the middle of its motion.",
    "Загрузите её, когда программа закончится и все оси остановятся; или с --online --while-running, "
    "убедившись, что станок может продолжать движение с новой логикой."};
const Entry kNotLogged{"plc.not-logged", "the change of the PLC could not be written to the change log: {0}",
                       "замена программы ПЛК не записана в журнал: {0}"};
const Entry kNoVariable{"plc.no-variable", "there is no variable or place '{0}'",
                        "переменной или места «{0}» нет"};
const Entry kNoValue{"plc.no-value", "'{0}' is no value for '{1}'", "«{0}» не является значением для «{1}»"};
const Entry kForced{"plc.forced", "{0} is forced to {1}", "{0} удерживается на {1}"};
const Entry kReleased{"plc.released", "{0} is let go", "{0} освобождена"};
const Entry kNotForced{"plc.not-forced", "'{0}' is not forced", "«{0}» не удерживается"};
const Entry kNothingForced{"plc.nothing-forced", "nothing is forced", "ничего не удерживается"};
const Entry kAllReleased{"plc.all-released", "everything is let go", "всё освобождено"};
const Entry kNoBody{"plc.no-body", "there is no program or instance '{0}'",
                    "программы или экземпляра «{0}» нет"};
const Entry kHeld{"plc.held-now", "the PLC is held; its outputs are off until it is let go",
                  "ПЛК удерживается; его выходы отключены, пока он не отпущен"};
const Entry kStepped{"plc.stepped", "{0} scans done", "выполнено сканов: {0}"};
const Entry kGoes{"plc.goes",
                  "the PLC runs freely again; `servogate reset` before the drives are switched on",
                  "ПЛК снова работает; перед включением приводов выполните `servogate reset`"};
const Entry kNotHolder{"plc.not-holder", "the PLC is not held by this client",
                       "этот клиент не удерживает ПЛК"};
const Entry kTooManyNames{"plc.names", "at most {0} names at a time", "не более {0} имён за раз"};

json told(const Entry& entry, const std::vector<std::string>& arguments, text::Language language) {
  return {{"ok", true}, {"exit", kDone}, {"text", text::render(entry, arguments, language)}};
}
json refused(const Entry& entry, const std::vector<std::string>& arguments, int exit,
             text::Language language) {
  return {
      {"ok", false}, {"code", entry.id}, {"text", text::render(entry, arguments, language)}, {"exit", exit}};
}

std::string joined(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& s : list) out += (out.empty() ? "" : ", ") + s;
  return out;
}

/// Type of an address (`%MW8`) by the format of its place; none of characters.
constexpr plc::Kind kBitStrings[] = {plc::Kind::boolean, plc::Kind::byte,  plc::Kind::word,
                                     plc::Kind::dword,   plc::Kind::dword, plc::Kind::lword};

/// Type of the PLC that a place of a packet has; nullptr: characters.
const plc::Type* type_of(const plc::TypeTable& types, image::Format format) {
  constexpr plc::Kind kKinds[] = {plc::Kind::boolean, plc::Kind::usint, plc::Kind::int_,
                                  plc::Kind::dint,    plc::Kind::real,  plc::Kind::lreal};
  const auto i = static_cast<std::size_t>(format);
  return i < std::size(kKinds) ? types.elementary(kKinds[i]) : nullptr;
}

std::optional<image::Place> machine_place(const machine::MachineConfig& m, const std::string& name) {
  for (const image::Symbol& s : m.symbol_table())
    if (plc::same_name(s.name, name)) return s.place;
  return image::parse_place(name);
}

/// What stands at a place that the program has no variable for, as JSON: numbers by the type of the place,
/// `%MW8` as a bit string, characters as a STRING. nullopt: the name is no place of this machine's packets.
std::optional<std::string> place_text(const machine::MachineConfig& m, const plc::TypeTable& types,
                                      const image::Packets& packets, const std::string& name) {
  const auto direct = plc::direct_place(name);
  const auto place = direct ? direct : machine_place(m, name);
  if (!place || !packets.contains(*place)) return std::nullopt;
  if (const plc::Type* type = type_of(types, place->format); type != nullptr && !direct) {
    std::uint8_t bytes[8] = {};
    plc::from_number(*type, packets.number(*place), bytes);
    return plc::to_json(*type, bytes);
  }
  const std::uint8_t* at = packets.data(place->packet) + place->byte();
  if (place->format == image::Format::bl) return packets.bit(*place) ? "true" : "false";
  if (place->format != image::Format::ch) {
    return plc::to_json(*types.elementary(kBitStrings[static_cast<std::size_t>(place->format)]), at);
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

json PlcDesk::ask(image::Request request, const PlcAsker& who) {
  request.asker = who.asker;
  image::Answer answer;
  if (!resident_.ask(request, answer)) return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
  if (answer.refusal == 0) return {{"ok", true}};
  return {{"ok", false},
          {"code", cycle::refusal_texts()[answer.refusal].id},
          {"text", cycle::render(answer, resident_.control().machine().letters(), who.language,
                                 resident_.control().machine().unit_words())},
          {"exit", kAlarm}};
}

json PlcDesk::change(const LogicChange& change, double value, const PlcAsker& who) {
  image::Request request;
  request.kind = image::RequestKind::logic;
  request.index = change.number;
  request.value = value;
  json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) resident_.control().logic()->withdraw(change.number);
  resident_.control().logic()->settle();
  return answer;
}

json PlcDesk::carry_out(const json& request, const PlcAsker& who) {
  if (resident_.control().logic() == nullptr) return refused(kNoPlc, {}, kAlarm, who.language);
  resident_.control().logic()->settle();
  const std::string command = request.value("cmd", "");
  if (command == "plc_load") return load(request, who);
  if (command == "plc_force") return force(request, who);
  if (command == "plc_release") return release(request, who);
  if (command == "plc_hold") return hold(who);
  if (command == "plc_step") return step(request, who);
  if (command == "plc_go") return go(who);
  if (command == "plc_watch") return watch(request, who);
  if (command == "plc_list") return list(who);
  return refused(says::kUnknown, {command}, kWrongUse, who.language);
}

json PlcDesk::load(const json& request, const PlcAsker& who) {
  Control& control = resident_.control();
  std::vector<std::string> names = request.value("files", std::vector<std::string>{});
  if (names.empty())
    for (const std::string& source : control.machine().plc.sources)
      names.push_back(control.machine().resolve(source));
  LogicChange change;
  change.kind = LogicChange::Kind::load;
  change.online = request.value("online", false);
  for (const std::string& name : names) {
    std::string reason;
    auto content = files::read_file(name, files::kMostOfSource, reason);
    if (!content) return refused(kNoFiles, {name + ": " + reason}, kWrongUse, who.language);
    change.files.push_back({name, std::move(*content)});
  }
  change.number = control.next_logic_change();
  const PlcLogic::Plan plan = control.prepare(change);
  json more{{"findings", json::parse(machine::to_json(plan.findings), nullptr, false)}};
  if (!plan.possible) {
    json answer = refused(kNotCompiled, {}, kAlarm, who.language);
    std::string words = answer["text"];
    for (const text::Finding& f : plan.findings) words += "\n" + f.str(who.language) + "\n" + f.excerpt();
    while (words.ends_with('\n')) words.pop_back();
    answer["text"] = words;
    answer.update(more);
    return answer;
  }
  json answer = this->change(change, request.value("while_running", false) ? 1.0 : 0.0, who);
  if (!answer["ok"].get<bool>()) {
    if (!change.online || !request.value("while_running", false))
      answer["text"] = answer["text"].get<std::string>() + "\n" +
                       text::render(kLoadLater, std::vector<std::string>{}, who.language);
    return answer;
  }
  for (const std::string& name : plan.forces_lost)
    std::erase_if(forces_, [&](const Force& f) { return f.places.empty() && plc::same_name(f.name, name); });
  answer = told(kChanged, {joined(names), std::to_string(plan.kept), std::to_string(plan.fresh.size())},
                who.language);
  more.update({{"files", names},
               {"online", change.online},
               {"kept", plan.kept},
               {"fresh", plan.fresh},
               {"given_up", plan.given_up},
               {"forces_lost", plan.forces_lost}});
  answer.update(more);
  if (const std::string problem = log(change, answer, who); !problem.empty())
    answer["text"] = answer["text"].get<std::string>() + "\n" +
                     text::render(kNotLogged, std::vector<std::string>{problem}, who.language);
  return answer;
}

/// One JSON object a line in plc-changes.jsonl of the state directory; empty: done, or there is none.
std::string PlcDesk::log(const LogicChange& change, const json& told, const PlcAsker& who) {
  if (resident_.state_path().empty()) return {};
  char when[32] = "";
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", &utc);
  json files = json::array();
  for (const plc::SourceFile& f : change.files)
    files.push_back({{"path", f.name}, {"sha256", report::sha256(f.text)}});
  const json entry{{"schema", 1},
                   {"when", when},
                   {"user", who.user},
                   {"cycle", resident_.image().now.number},
                   {"online", change.online},
                   {"files", files},
                   {"kept", told["kept"]},
                   {"fresh", told["fresh"]},
                   {"given_up", told["given_up"]}};
  std::error_code code;
  std::filesystem::create_directories(resident_.state_path(), code);
  const std::string path = (std::filesystem::path(resident_.state_path()) / "plc-changes.jsonl").string();
  const std::string line = entry.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const bool good = fd >= 0 && ::write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                    ::fsync(fd) == 0;
  const int problem = errno;
  if (fd >= 0) ::close(fd);
  return good ? std::string() : path + ": " + text::words_of(problem);
}

/// The place of a packet that a name means: of the program's variable there, a point of the machine, or an
/// address. nullopt: a variable of the program alone, or nothing.
std::optional<image::Place> PlcDesk::place_of(const std::string& name) const {
  Control& control = resident_.control();
  const std::shared_ptr<const LogicProgram> program = control.logic()->program();
  if (const auto handle = program->engine.find(name)) {
    if (handle->place < 0) return std::nullopt;
    return program->engine.image().places[static_cast<std::size_t>(handle->place)].place;
  }
  const auto direct = plc::direct_place(name);
  return direct ? direct : machine_place(control.machine(), name);
}

/// The requests that force a packet place to a value, none: the name is no place, or a string that a variable
/// mirrors, which is held there. `wrong`: no such value.
std::vector<image::Request> PlcDesk::place_requests(const std::string& name, const std::string& value,
                                                    bool& wrong) {
  const std::shared_ptr<const LogicProgram> program = resident_.control().logic()->program();
  const bool variable = program->engine.find(name).has_value();
  const std::optional<image::Place> place = place_of(name);
  if (!place || (place->format == image::Format::ch && variable)) return {};
  image::Request request;
  request.kind = image::RequestKind::force;
  request.packet = static_cast<std::uint8_t>(place->packet);
  request.format = static_cast<std::uint8_t>(place->format);
  request.index = place->index;
  request.length = place->length;
  if (place->format == image::Format::ch) {  // a request holds a number: one for each character
    plc::Type text;
    text.kind = plc::Kind::string;
    text.size = 1 + place->bytes();
    std::vector<std::uint8_t> bytes(text.size, ' ');
    wrong = !plc::parse_value(text, value, bytes.data());
    std::fill(bytes.begin() + 1 + (wrong ? 0 : bytes[0]), bytes.end(), ' ');
    request.format = static_cast<std::uint8_t>(image::Format::by);
    std::vector<image::Request> out;
    for (std::uint32_t n = 0; n < place->bytes(); ++n) {
      request.index = place->byte() + n;
      request.length = 1;
      request.value = bytes[1 + n];
      out.push_back(request);
    }
    return out;
  }
  const plc::TypeTable& types = *program->engine.image().types;
  const plc::Type* const number = type_of(types, place->format);
  const plc::Type* const bits = types.elementary(kBitStrings[static_cast<std::size_t>(place->format)]);
  std::uint8_t bytes[8] = {};
  // `%MW8` is a bit string and as such has other literals than the number at its place.
  wrong = !plc::parse_value(*number, value, bytes) &&
          !(plc::direct_place(name) && plc::parse_value(*bits, value, bytes));
  if (!wrong) request.value = plc::to_number(*number, bytes);
  return {request};
}

/// All of them or none.
json PlcDesk::force_places(std::vector<image::Request> requests, const PlcAsker& who) {
  for (std::size_t n = 0; n < requests.size(); ++n) {
    json answer = ask(requests[n], who);
    if (answer["ok"].get<bool>()) continue;
    while (n-- > 0) {
      requests[n].kind = image::RequestKind::release_force;
      requests[n].value = 0.0;
      ask(requests[n], who);
    }
    return answer;
  }
  return {{"ok", true}};
}

json PlcDesk::force(const json& request, const PlcAsker& who) {
  Force f;
  f.name = request.value("name", "");
  f.value = request.value("value", "");
  f.user = who.user;
  f.owner = request.value("stay", false) ? 0 : who.connection;
  bool wrong = false;
  json answer;
  f.places = place_requests(f.name, f.value, wrong);
  if (!f.places.empty()) {
    if (wrong || f.value.empty()) return refused(kNoValue, {f.value, f.name}, kWrongUse, who.language);
    answer = force_places(f.places, who);
    for (image::Request& place : f.places) {
      place.kind = image::RequestKind::release_force;
      place.value = 0.0;
    }
  } else {
    LogicChange change;
    change.kind = LogicChange::Kind::force;
    change.name = f.name;
    change.value = f.value;
    change.number = resident_.control().next_logic_change();
    if (!resident_.control().logic()->program()->engine.find(f.name))
      return refused(kNoVariable, {f.name}, kWrongUse, who.language);
    if (!resident_.control().prepare(change).possible)
      return refused(kNoValue, {f.value, f.name}, kWrongUse, who.language);
    answer = this->change(change, 1.0, who);
  }
  if (!answer["ok"].get<bool>()) return answer;
  std::erase_if(forces_, [&](const Force& other) { return plc::same_name(other.name, f.name); });
  forces_.push_back(f);
  return told(kForced, {f.name, f.value}, who.language);
}

bool PlcDesk::let_go(const Force& force, const PlcAsker& who) {
  if (!force.places.empty())
    return std::all_of(force.places.begin(), force.places.end(),
                       [&](const image::Request& r) { return ask(r, who)["ok"].get<bool>(); });
  LogicChange change;
  change.kind = LogicChange::Kind::release;
  change.name = force.name;
  change.number = resident_.control().next_logic_change();
  return !resident_.control().prepare(change).possible || this->change(change, 1.0, who)["ok"].get<bool>();
}

json PlcDesk::release(const json& request, const PlcAsker& who) {
  const std::string name = request.value("name", "");
  const bool all = name.empty();
  if (all && forces_.empty()) return told(kNothingForced, {}, who.language);
  bool found = false;
  for (std::size_t i = forces_.size(); i-- > 0;) {
    if (!all && !plc::same_name(forces_[i].name, name)) continue;
    found = true;
    if (!let_go(forces_[i], who)) return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
    forces_.erase(forces_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (!found) return refused(kNotForced, {name}, kWrongUse, who.language);
  return all ? told(kAllReleased, {}, who.language) : told(kReleased, {name}, who.language);
}

json PlcDesk::hold(const PlcAsker& who) {
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  request.value = 1.0;
  const json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) return answer;
  held_by_ = who.connection;
  holder_ = who.user;
  return told(kHeld, {}, who.language);
}

json PlcDesk::step(const json& request, const PlcAsker& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refused(kNotHolder, {}, kAlarm, who.language);
  image::Request scans;
  scans.kind = image::RequestKind::logic_scan;
  scans.value = 2.0;
  const double wanted = request.value("scans", 1.0);
  const bool whole = wanted >= 1.0 && wanted <= 1e9 && wanted == std::floor(wanted);
  scans.index = whole ? static_cast<std::uint32_t>(wanted) : 0;  // which the gate refuses
  const json answer = ask(scans, who);
  if (!answer["ok"].get<bool>()) return answer;
  return told(kStepped, {std::to_string(scans.index)}, who.language);
}

json PlcDesk::go(const PlcAsker& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refused(kNotHolder, {}, kAlarm, who.language);
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  const json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) return answer;
  held_by_ = 0;
  holder_.clear();
  return told(kGoes, {}, who.language);
}

void PlcDesk::release_of(std::uint64_t connection) {
  if (connection != 0 && held_by_ == connection) {
    PlcAsker gone;
    gone.connection = connection;
    go(gone);
  }
  for (std::size_t i = forces_.size(); i-- > 0;)
    if (forces_[i].owner == connection && connection != 0) {
      let_go(forces_[i], {});
      forces_.erase(forces_.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

json PlcDesk::forced() const {
  json out = json::array();
  for (const Force& f : forces_)
    out.push_back({{"name", f.name}, {"value", f.value}, {"user", f.user}, {"stays", f.owner == 0}});
  return out;
}

/// What forces it: by this name, by another one of the same variable, or of a place that it shares.
const PlcDesk::Force* PlcDesk::force_of(const std::string& name) const {
  const std::optional<image::Place> place = place_of(name);
  const auto& engine = resident_.control().logic()->program()->engine;
  const auto mine = engine.find(name);
  for (const Force& f : forces_) {
    if (plc::same_name(f.name, name)) return &f;
    const auto other = place_of(f.name);
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
  const std::optional<image::Place> place = place_of(name);
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

json PlcDesk::watch(const json& request, const PlcAsker& who) {
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
      text = forced_value(names[i], *handles[i]->type)
                 .value_or(plc::to_json(*handles[i]->type, sample.bytes.data() + at, handles[i]->bit));
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

json PlcDesk::watch_body(const std::string& name, const PlcAsker& who) {
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
          forced_value(full, *v.type).value_or(plc::to_json(*v.type, sample.bytes.data() + at));
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

json PlcDesk::list(const PlcAsker&) {
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
