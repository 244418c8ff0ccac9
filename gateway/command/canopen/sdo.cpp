// SPDX-License-Identifier: Apache-2.0
// `servogate sdo`: one object of one node.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/inspect/moving_objects.hpp"
#include "firmware_if/canopen/inspect/object_catalogue.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "gateway/command/canopen/data_sheet.hpp"
#include "gateway/command/canopen/object_value.hpp"
#include "gateway/command/commands.hpp"
#include "machine/files/output_files.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::address_text;
using canopen::can_move;
using canopen::encode_value;
using canopen::guess_type;
using canopen::hex_text;
using canopen::may_be;
using canopen::ObjectAddress;
using canopen::ObjectCatalogue;
using canopen::parse_address;
using canopen::show_value;
using canopen::takes_energy_away;
using canopen::type_named;
using canopen::type_words;
using canopen::ValueType;
using nlohmann::json;

const text::Entry kBadObject{"sdo.bad-object",
                             "'{0}' is no object; expected INDEX[:SUB], hexadecimal: 6041, 1018:4",
                             "«{0}» — не объект; нужно INDEX[:SUB] в шестнадцатеричном виде: 6041, 1018:4"};
const text::Entry kBadType{"sdo.bad-type", "'{0}' is no type; known: {1}", "«{0}» — не тип; известны: {1}"};
const text::Entry kNoType{
    "sdo.no-type", "the type of {0} is not known here: say it ({1}), or name a data sheet with --eds",
    "тип объекта {0} здесь неизвестен: укажите его ({1}) или файл описания через --eds"};
const text::Entry kBadValue{"sdo.bad-value", "'{0}' is no value of the type {1}",
                            "«{0}» — не значение типа {1}"};
const text::Entry kEmpty{"sdo.empty", "only a text or bytes (str, hex) may be empty",
                         "пустыми бывают только текст и байты (str, hex)"};
const text::Entry kNoValue{"sdo.no-value", "`servogate sdo write` needs a value",
                           "для `servogate sdo write` нужно значение"};
const text::Entry kTooMuch{"sdo.too-much", "`servogate sdo read` takes a type only, no value",
                           "`servogate sdo read` принимает только тип, без значения"};
const text::Entry kAnyway{"sdo.anyway", "--anyway is for reading: a write needs a bus without a master",
                          "--anyway — для чтения: запись требует шины без ведущего"};
const text::Entry kCannotRead{"sdo.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};
const text::Entry kFailed{"sdo.failed", "node {0}, {1}: {2}", "узел {0}, {1}: {2}"};
const text::Entry kWrite{"sdo.write", "writing {0}", "запись {0}"};
const text::Entry kWritten{"sdo.written", "{0} of node {1} is {2}", "{0} узла {1}: записано {2}"};

/// What the words of the command line ask for.
struct Request {
  ObjectAddress at;
  const ValueType* type = nullptr;  ///< nullptr: by what comes
  bool type_given = false;          ///< on the command line, else of the object by that number in a drive
  std::vector<std::uint8_t> data;   ///< of a write
  std::string name;
};

int wrong(const text::Entry& entry, const std::vector<std::string>& arguments) {
  complain(entry, arguments);
  return kWrongUse;
}

int read_value(const std::string& word, Request& request) {
  if (word.starts_with('@')) {
    std::string why;
    const auto bytes = files::read_file(word.substr(1), files::kMostOfSource, why);
    if (!bytes) return wrong(kCannotRead, {word.substr(1), why});
    request.data.assign(bytes->begin(), bytes->end());
  } else {
    const std::string place = address_text(request.at.index, request.at.subindex);
    if (request.type == nullptr) return wrong(kNoType, {place, type_words()});
    const auto data = encode_value(word, *request.type);
    if (!data) return wrong(kBadValue, {word, std::string(request.type->name)});
    request.data = *data;
  }
  const bool may_be_empty = request.type != nullptr && canopen::eds_type_string(request.type->data_type);
  return request.data.empty() && !may_be_empty ? wrong(kEmpty, {}) : kDone;
}

int read_request(const SdoOptions& options, const ObjectCatalogue& catalogue, Request& request) {
  const auto at = parse_address(options.object);
  if (!at) return wrong(kBadObject, {options.object});
  request.at = *at;
  request.name = catalogue.name(at->index, at->subindex);
  request.type = catalogue.type(at->index, at->subindex);
  const bool writes = options.action == "write";
  if (writes && options.anyway) return wrong(kAnyway, {});
  const std::size_t values = writes ? 1 : 0;
  if (options.words.size() < values) return wrong(kNoValue, {});
  if (options.words.size() > values + 1) return wrong(kTooMuch, {});
  if (options.words.size() == values + 1) {
    request.type = type_named(options.words.back());
    request.type_given = true;
    if (request.type == nullptr) return wrong(kBadType, {options.words.back(), type_words()});
  }
  return writes ? read_value(options.words.front(), request) : kDone;
}

json head(const SdoOptions& options, const Request& request) {
  char index[8];
  std::snprintf(index, sizeof index, "%04X", request.at.index);
  return {{"schema", 1},
          {"node", options.node},
          {"index", index},
          {"subindex", request.at.subindex},
          {"name", request.name}};
}

void print_json(const json& out) { print_exact(out.dump(1, ' ', false, json::error_handler_t::replace)); }

int fail(const SdoOptions& options, const Request& request, const SdoOutcome& outcome,
         const std::string& instead) {
  const std::string why = instead.empty() ? outcome.why() : instead;
  if (options.json) {
    json out = head(options, request);
    out["ok"] = false;
    out["error"] = why;
    if (outcome.abort != canopen::AbortCode::none) out["abort"] = static_cast<std::uint32_t>(outcome.abort);
    print_json(out);
  }
  complain(kFailed, {std::to_string(options.node), address_text(request.at.index, request.at.subindex), why});
  return kAlarm;
}

int save_bytes(const std::string& path, const std::vector<std::uint8_t>& data) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
  if (file.flush()) return kDone;
  complain(kCannotWrite, {path, text::words_of(errno)});
  return kInfrastructure;
}

int show(const SdoOptions& options, Request request, const std::vector<std::uint8_t>& data) {
  const ValueType* type = request.type;
  // Another profile has another object by the same number: 6502h of an encoder is not that of a drive.
  if (type != nullptr && !request.type_given && !may_be(data, *type)) {
    type = nullptr;
    request.name.clear();
  }
  if (type == nullptr) type = guess_type(data);
  if (options.json) {
    json out = head(options, request);
    out["ok"] = true;
    out["type"] = type->name;
    out["value"] = json_value(data, type);
    out["bytes"] = hex_text(data);
    print_json(out);
    return kDone;
  }
  const std::string place = address_text(request.at.index, request.at.subindex);
  print_line(place + (request.name.empty() ? "" : " " + request.name) + " = " + show_value(data, type));
  return kDone;
}

int write(const SdoOptions& options, const Request& request, ToolBus& bus) {
  const std::string place = address_text(request.at.index, request.at.subindex);
  const std::string what =
      text::both(text::render(kWrite, std::vector<std::string>{place}, text::Language::english),
                 text::render(kWrite, std::vector<std::string>{place}, text::Language::russian));
  const bool at_once = takes_energy_away(request.at.index, request.at.subindex, request.data);
  if (const int code = at_once                      ? kDone
                       : can_move(request.at.index) ? may_move(bus, what, options)
                                                    : must_be_idle(bus, what, options);
      code != kDone)
    return code;
  const SdoOutcome outcome = bus.write(static_cast<canopen::NodeId>(options.node), request.at.index,
                                       request.at.subindex, request.data);
  if (!outcome.ok()) return fail(options, request, outcome, {});
  if (options.json) return show(options, request, request.data);
  const ValueType* type = request.type != nullptr ? request.type : type_named("hex");
  print_line(text::render(
      kWritten,
      std::vector<std::string>{place, std::to_string(options.node),
                               request.data.size() > 64 ? std::to_string(request.data.size()) + " B"
                                                        : show_value(request.data, type)},
      text::user_language()));
  return kDone;
}

int read(const SdoOptions& options, const Request& request, SdoAccess& access, const std::string* refusal) {
  const SdoOutcome outcome =
      access.read(static_cast<canopen::NodeId>(options.node), request.at.index, request.at.subindex);
  if (!outcome.ok()) return fail(options, request, outcome, refusal != nullptr ? *refusal : "");
  if (!options.save.empty())
    if (const int code = save_bytes(options.save, outcome.data); code != kDone) return code;
  return show(options, request, outcome.data);
}

}  // namespace

int sdo(const SdoOptions& options) {
  std::optional<canopen::Eds> eds;
  if (!options.eds.empty()) {
    eds = read_data_sheet(options.eds);
    if (!eds) return kWrongUse;
  }
  Request request;
  if (const int code = read_request(options, ObjectCatalogue(eds ? &*eds : nullptr), request); code != kDone)
    return code;
  if (const auto problem = files::problem_of_outputs({{"--save", options.save}}, {{"--eds", options.eds}})) {
    complain(*problem->entry, problem->arguments);
    return problem->wrong_use ? kWrongUse : kInfrastructure;
  }
  int code = kDone;
  std::optional<Holder> holder;
  const bool writes = options.action == "write";
  const bool at_once = writes && takes_energy_away(request.at.index, request.at.subindex, request.data);
  if (!find_holder(options.bus, holder, code, at_once)) return code;
  if (holder && writes) return refuse_held(*holder, options.bus, "`sdo write`");
  if (holder) {
    const auto held = HeldBus::open(*holder, options.timeout_ms);
    return held == nullptr ? kInfrastructure : read(options, request, *held, &held->refusal());
  }
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  if (writes) return bus->finish(write(options, request, *bus));
  code = may_read(*bus, options);
  return bus->finish(code == kDone ? read(options, request, *bus, nullptr) : code);
}

}  // namespace servogate::gateway::command
