// SPDX-License-Identifier: Apache-2.0
// `servogate sdo`: objects of one node.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/inspect/moving_objects.hpp"
#include "firmware_if/canopen/inspect/value_meaning.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/data_sheet.hpp"
#include "gateway/command/canopen/object_value.hpp"
#include "gateway/command/canopen/sdo_request.hpp"
#include "gateway/command/commands.hpp"
#include "machine/files/output_files.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::address_text;
using canopen::can_move;
using canopen::guess_type;
using canopen::hex_text;
using canopen::may_be;
using canopen::ObjectCatalogue;
using canopen::show_value;
using canopen::takes_energy_away;
using canopen::type_named;
using canopen::ValueType;
using nlohmann::json;

const text::Entry kFailed{"sdo.failed", "node {0}, {1}: {2}", "узел {0}, {1}: {2}"};
const text::Entry kWrite{"sdo.write", "writing {0}", "запись {0}"};
const text::Entry kWritten{"sdo.written", "{0} of node {1} is {2}", "{0} узла {1}: записано {2}"};
const text::Entry kOneFile{"sdo.one-file", "--save is for one object that is read",
                           "--save — для одного читаемого объекта"};
const text::Entry kNotDone{"sdo.not-done", "not done any more: {0}", "дальнейшее не выполнено: {0}"};

/// The accesses of one call, and what came of them.
class Accesses {
 public:
  Accesses(const SdoOptions& options, const std::vector<SdoRequest>& requests)
      : options_(options), requests_(requests) {}

  /// One after the other; the first write that fails ends them. The exit code of the first that failed.
  int carry_out(SdoAccess& access, const std::function<bool()>& over, const std::string* refusal) {
    int code = kDone;
    for (std::size_t i = 0; i < requests_.size() && !over(); ++i) {
      const SdoRequest& request = requests_[i];
      const int one = request.write ? write(request, access) : read(request, access, refusal);
      if (code == kDone) code = one;
      if (one == kDone || !request.write || i + 1 == requests_.size()) continue;
      std::string left;
      for (std::size_t k = i + 1; k < requests_.size(); ++k)
        left += (left.empty() ? "" : ", ") + address_text(requests_[k].at.index, requests_[k].at.subindex);
      complain(kNotDone, {left});
      break;
    }
    if (options_.json) print_facts();
    return code;
  }

 private:
  json& row(const SdoRequest& request) {
    char index[8];
    std::snprintf(index, sizeof index, "%04X", request.at.index);
    rows_.push_back({{"index", index}, {"subindex", request.at.subindex}, {"name", request.name}});
    return rows_.back();
  }

  /// One access is the object itself, several are its list.
  void print_facts() const {
    json out{{"schema", 1}, {"node", options_.node}};
    if (requests_.size() == 1 && rows_.size() == 1)
      out.update(rows_.front());
    else
      out["accesses"] = rows_;
    print_exact(out.dump(1, ' ', false, json::error_handler_t::replace));
  }

  int fail(const SdoRequest& request, const SdoOutcome& outcome, const std::string& instead) {
    const std::string why = instead.empty() ? outcome.why() : instead;
    json& out = row(request);
    out["ok"] = false;
    out["error"] = why;
    if (outcome.abort != canopen::AbortCode::none) out["abort"] = static_cast<std::uint32_t>(outcome.abort);
    keep_order();
    complain(kFailed,
             {std::to_string(options_.node), address_text(request.at.index, request.at.subindex), why});
    return kAlarm;
  }

  int show(SdoRequest request, const std::vector<std::uint8_t>& data) {
    const ValueType* type = request.type;
    std::string meaning =
        canopen::meaning_of(request.at.index, request.at.subindex, data, text::user_language());
    // Another profile has another object by the same number: 6502h of an encoder is not that of a drive.
    if (type != nullptr && !request.type_given && !may_be(data, *type)) {
      type = nullptr;
      request.name.clear();
      meaning.clear();
    }
    if (type == nullptr) type = guess_type(data);
    json& out = row(request);
    out["ok"] = true;
    out["type"] = type->name;
    out["value"] = json_value(data, type);
    out["bytes"] = hex_text(data);
    if (!meaning.empty()) out["meaning"] = meaning;
    if (options_.json) return kDone;
    const std::string place = address_text(request.at.index, request.at.subindex);
    print_line(place + (request.name.empty() ? "" : " " + request.name) + " = " + show_value(data, type) +
               (meaning.empty() ? "" : ": " + meaning));
    return kDone;
  }

  int write(const SdoRequest& request, SdoAccess& access) {
    const SdoOutcome outcome = access.write(static_cast<canopen::NodeId>(options_.node), request.at.index,
                                            request.at.subindex, request.data);
    if (!outcome.ok()) return fail(request, outcome, {});
    if (options_.json) return show(request, request.data);
    const ValueType* type = request.type != nullptr ? request.type : type_named("hex");
    print_line(text::render(
        kWritten,
        std::vector<std::string>{address_text(request.at.index, request.at.subindex),
                                 std::to_string(options_.node),
                                 request.data.size() > 64 ? std::to_string(request.data.size()) + " B"
                                                          : show_value(request.data, type)},
        text::user_language()));
    return kDone;
  }

  int read(const SdoRequest& request, SdoAccess& access, const std::string* refusal) {
    const SdoOutcome outcome =
        access.read(static_cast<canopen::NodeId>(options_.node), request.at.index, request.at.subindex);
    if (!outcome.ok()) return fail(request, outcome, refusal != nullptr ? *refusal : "");
    if (!options_.save.empty())
      if (const int code = save_bytes(outcome.data); code != kDone) return code;
    return show(request, outcome.data);
  }

  int save_bytes(const std::vector<std::uint8_t>& data) const {
    std::ofstream file(options_.save, std::ios::binary);
    file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    if (file.flush()) return kDone;
    complain(kCannotWrite, {options_.save, text::words_of(errno)});
    return kInfrastructure;
  }

  const SdoOptions& options_;
  const std::vector<SdoRequest>& requests_;
  json rows_ = json::array();
};

bool at_once(const SdoRequest& r) { return r.write && takes_energy_away(r.at.index, r.at.subindex, r.data); }

/// The gate of the strictest of the accesses.
int gate(ToolBus& bus, const SdoOptions& options, const std::vector<SdoRequest>& requests) {
  const auto strict = [](const SdoRequest& r) {
    return !r.write || at_once(r) ? 0 : can_move(r.at.index) ? 2 : 1;
  };
  const auto strictest = std::max_element(
      requests.begin(), requests.end(), [&](const auto& a, const auto& b) { return strict(a) < strict(b); });
  const std::string place = address_text(strictest->at.index, strictest->at.subindex);
  const std::string what =
      text::both(text::render(kWrite, std::vector<std::string>{place}, text::Language::english),
                 text::render(kWrite, std::vector<std::string>{place}, text::Language::russian));
  if (strict(*strictest) == 2) return may_move(bus, what, options);
  if (strict(*strictest) == 1) return must_be_idle(bus, what, options);
  return std::all_of(requests.begin(), requests.end(), at_once) ? kDone : may_read(bus, options);
}

}  // namespace

int sdo(const SdoOptions& options) {
  std::optional<canopen::Eds> eds;
  if (!options.eds.empty()) {
    eds = read_data_sheet(options.eds);
    if (!eds) return kWrongUse;
  }
  std::vector<SdoRequest> requests;
  if (!read_sdo_requests(options, ObjectCatalogue(eds ? &*eds : nullptr), requests)) return kWrongUse;
  if (!options.save.empty() && (requests.size() != 1 || requests.front().write)) {
    complain(kOneFile, {});
    return kWrongUse;
  }
  if (const auto problem = files::problem_of_outputs({{"--save", options.save}}, {{"--eds", options.eds}})) {
    complain(*problem->entry, problem->arguments);
    return problem->wrong_use ? kWrongUse : kInfrastructure;
  }
  int code = kDone;
  std::optional<Holder> holder;
  const bool writes = std::any_of(requests.begin(), requests.end(), [](const auto& r) { return r.write; });
  if (!find_holder(options.bus, holder, code, std::all_of(requests.begin(), requests.end(), at_once)))
    return code;
  if (holder && writes) return refuse_held(*holder, options.bus, "`sdo write`");
  Accesses accesses(options, requests);
  if (holder) {
    const auto held = HeldBus::open(*holder, options.timeout_ms);
    return held == nullptr ? kInfrastructure
                           : accesses.carry_out(
                                 *held, [] { return false; }, &held->refusal());
  }
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  if (code = gate(*bus, options, requests); code != kDone) return bus->finish(code);
  return bus->finish(accesses.carry_out(
      *bus, [&] { return bus->over(); }, nullptr));
}

}  // namespace servogate::gateway::command
