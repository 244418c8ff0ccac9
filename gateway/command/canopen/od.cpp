// SPDX-License-Identifier: Apache-2.0
// `servogate od`: the object dictionary of a node.
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/inspect/object_catalogue.hpp"
#include "firmware_if/canopen/inspect/object_walk.hpp"
#include "firmware_if/canopen/inspect/value_meaning.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/data_sheet.hpp"
#include "gateway/command/canopen/object_value.hpp"
#include "gateway/command/canopen/od_parameters.hpp"
#include "gateway/command/canopen/sheet_file.hpp"
#include "gateway/command/commands.hpp"
#include "machine/files/output_files.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::guess_type;
using canopen::hex_text;
using canopen::IndexRange;
using canopen::ObjectCatalogue;
using canopen::parse_address;
using canopen::ReadObject;
using canopen::show_value;
using canopen::ValueType;
using nlohmann::json;

const text::Entry kBadRange{"od.bad-range", "'{0}' is no range; expected FIRST-LAST, hexadecimal: 2000-5FFF",
                            "«{0}» — не диапазон; нужно FIRST-LAST в шестнадцатеричном виде: 2000-5FFF"};
const text::Entry kSilent{"od.silent", "node {0} does not answer{1}", "узел {0} не отвечает{1}"};
const text::Entry kSaved{"od.saved", "{0}: {1} values of node {2}", "{0}: значений узла {2} — {1}"};
const text::Entry kNotSaved{"od.not-saved", "{0}: not saved, a DCF cannot hold their values: {1}",
                            "{0}: не сохранены, их значения нельзя записать в DCF: {1}"};
const text::Entry kOwnSheet{"od.own-sheet", "{0}: the EDS that node {1} itself stores in 1021h, {2} bytes",
                            "{0}: EDS, который узел {1} сам хранит в 1021h, байтов: {2}"};
const text::Entry kOwnFormat{
    "od.own-format",
    "the EDS that node {0} stores in 1021h is in a format of its maker (1022h = {1}); not used",
    "EDS, который узел {0} хранит в 1021h, в формате изготовителя (1022h = {1}); не используется"};
const text::Entry kOwnBroken{"od.own-broken", "what node {0} stores in 1021h is no EDS; not used",
                             "то, что узел {0} хранит в 1021h, — не EDS; не используется"};
const text::Entry kOwnUnread{"od.own-unread", "the EDS that node {0} stores in 1021h cannot be read: {1}",
                             "EDS, который узел {0} хранит в 1021h, не читается: {1}"};

void print_objects(const OdWork& work, const ObjectCatalogue& catalogue,
                   const std::vector<ReadObject>& objects) {
  json list = json::array();
  for (const ReadObject& o : objects) {
    const ValueType* type = catalogue.type(o.index, o.subindex);
    if (type == nullptr && o.outcome.ok()) type = guess_type(o.outcome.data);
    const std::string value = o.outcome.ok() ? show_value(o.outcome.data, type) : o.outcome.why();
    const std::string meaning =
        canopen::meaning_of(o.index, o.subindex, o.outcome.data, text::user_language());
    if (!work.options.json) {
      print_line(place_words(catalogue, o.index, o.subindex) + (o.outcome.ok() ? " = " : ": ") + value +
                 (meaning.empty() ? "" : ": " + meaning));
      continue;
    }
    json row = place_json(catalogue, o.index, o.subindex);
    if (o.outcome.ok()) {
      row["type"] = type->name;
      row["value"] = json_value(o.outcome.data, type);
      row["bytes"] = hex_text(o.outcome.data);
      if (!meaning.empty()) row["meaning"] = meaning;
    } else {
      row["error"] = value;
      row["abort"] = static_cast<std::uint32_t>(o.outcome.abort);
    }
    list.push_back(std::move(row));
  }
  if (!work.options.json) return;
  json out = head(work.options);
  out["objects"] = std::move(list);
  print_json(out);
}

int save(const OdWork& work, const std::vector<ReadObject>& objects, const canopen::Eds* eds) {
  std::ofstream file(work.options.save, std::ios::binary);
  std::vector<std::string> not_saved;
  file << canopen::write_dcf(
      canopen::saved_configuration(objects, eds, work.node(), work.bit_rate, not_saved));
  if (!file.flush()) {
    complain(kCannotWrite, {work.options.save, text::words_of(errno)});
    return kInfrastructure;
  }
  std::string places;
  for (const std::string& place : not_saved) places += (places.empty() ? "" : ", ") + place;
  if (!places.empty()) complain(kNotSaved, {work.options.save, places});
  const auto read =
      std::count_if(objects.begin(), objects.end(), [](const auto& o) { return o.outcome.ok(); });
  tell(say(kSaved, {work.options.save, std::to_string(read), std::to_string(work.options.node)}));
  return kDone;
}

/// The data sheet that a device stores itself. Source: CiA 301, 7.5.2.20 and 7.5.2.21 (1021h, 1022h).
struct OwnSheet {
  std::string bytes;
  canopen::Eds eds;
};
std::optional<OwnSheet> own_sheet(const OdWork& work) {
  constexpr std::uint16_t kStoreEds = 0x1021, kStoreFormat = 0x1022;
  const std::string node = std::to_string(work.options.node);
  const SdoOutcome stored = work.access.read(work.node(), kStoreEds, 0);
  if (stored.abort == canopen::AbortCode::object_does_not_exist || (stored.ok() && stored.data.empty()))
    return std::nullopt;
  if (!stored.ok()) {
    complain(kOwnUnread, {node, stored.why()});
    return std::nullopt;
  }
  const SdoOutcome format = work.access.read(work.node(), kStoreFormat, 0);
  if (format.ok() && canopen::load_le(format.data) != 0) {
    complain(kOwnFormat, {node, std::to_string(canopen::load_le(format.data))});
    return std::nullopt;
  }
  OwnSheet own{{stored.data.begin(), stored.data.end()}, {}};
  canopen::EdsResult read = canopen::read_eds(own.bytes, "1021h");
  if (!read.ok()) {
    complain(kOwnBroken, {node});
    return std::nullopt;
  }
  print_findings(read.findings);
  own.eds = std::move(read.eds);
  return own;
}

int write_own(const OdWork& work, const OwnSheet& own) {
  if (const int code = write_bytes(work.options.write_eds, own.bytes); code != kDone) return code;
  tell(say(kOwnSheet,
           {work.options.write_eds, std::to_string(work.options.node), std::to_string(own.bytes.size())}));
  return kDone;
}

int write_found(const OdWork& work, std::vector<ReadObject> objects, const canopen::Eds* eds,
                const std::vector<IndexRange>& ranges) {
  canopen::SheetOrigin origin = sheet_origin(work.options.write_eds, "servogate od");
  origin.node = work.node();
  origin.bit_rate = work.bit_rate;
  if (eds == nullptr || !work.options.range.empty()) origin.ranges = ranges;
  if (eds == nullptr) canopen::read_unused_places(work.access, work.node(), objects, work.over);
  if (work.over()) return kInfrastructure;
  return write_sheet(work.options.write_eds, canopen::sheet_of_device(objects, eds, origin), work.node());
}

/// FIRST-LAST; false: it is none.
bool parse_range(const std::string& text, IndexRange& range) {
  const std::size_t dash = text.find('-');
  const auto first = parse_address(text.substr(0, dash));
  const auto last = dash == std::string::npos ? first : parse_address(text.substr(dash + 1));
  if (!first || !last || last->index < first->index) return false;
  range = {first->index, last->index};
  return true;
}

int work_on(const OdWork& work, const canopen::Eds* eds, const canopen::Eds* file,
            const std::vector<IndexRange>& ranges, const std::string* refusal) {
  const SdoOutcome alive = work.access.read(work.node(), 0x1000, 0);
  if (!alive.answered()) {
    complain(kSilent, {std::to_string(work.options.node),
                       refusal != nullptr && !refusal->empty() ? ": " + *refusal : ""});
    return kAlarm;
  }
  if (file != nullptr)
    return work.options.restore.empty() ? compare_parameters(work, *file) : restore_parameters(work, *file);
  const std::optional<OwnSheet> own = work.options.write_eds.empty() ? std::nullopt : own_sheet(work);
  if (own && eds == nullptr) eds = &own->eds;
  const std::vector<ReadObject> objects =
      eds != nullptr && work.options.range.empty()
          ? canopen::read_listed(work.access, work.node(), *eds, work.over)
          : canopen::walk(work.access, work.node(), ranges, work.over);
  if (work.over()) return kInfrastructure;
  print_objects(work, ObjectCatalogue(eds), objects);
  if (!objects.empty() && !objects.back().outcome.answered()) {
    complain(kSilent, {std::to_string(work.options.node), ""});
    return kAlarm;
  }
  if (!work.options.save.empty())
    if (const int code = save(work, objects, eds); code != kDone) return code;
  if (work.options.write_eds.empty()) return kDone;
  return own ? write_own(work, *own) : write_found(work, objects, eds, ranges);
}

}  // namespace

int od(const OdOptions& options) {
  std::vector<IndexRange> ranges = canopen::standard_areas();
  // An EDS is to have the manufacturer's objects, too, although it takes a while to look for them.
  if (!options.write_eds.empty()) ranges.push_back({0x2000, 0x5FFF});
  if (!options.range.empty()) {
    ranges.resize(1);
    if (!parse_range(options.range, ranges.front())) {
      complain(kBadRange, {options.range});
      return kWrongUse;
    }
  }
  if (const auto problem = files::problem_of_outputs(
          {{"--save", options.save}, {"--write-eds", options.write_eds}},
          {{"--eds", options.eds}, {"--compare", options.compare}, {"--restore", options.restore}})) {
    complain(*problem->entry, problem->arguments);
    return problem->wrong_use ? kWrongUse : kInfrastructure;
  }
  std::optional<canopen::Eds> eds, file;
  if (!options.eds.empty() && !(eds = read_data_sheet(options.eds))) return kWrongUse;
  const std::string& configuration = options.restore.empty() ? options.compare : options.restore;
  if (!configuration.empty() && !(file = read_data_sheet(configuration))) return kWrongUse;
  if (file) canopen::follow_node(*file);
  const canopen::Eds* sheet = eds ? &*eds : nullptr;
  const canopen::Eds* other = file ? &*file : nullptr;
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(options.bus, holder, code)) return code;
  if (holder && !options.restore.empty()) return refuse_held(*holder, options.bus, "`od --restore`");
  if (holder) {
    const auto held = HeldBus::open(*holder, options.timeout_ms);
    if (held == nullptr) return kInfrastructure;
    return work_on({options, *held, [] { return false; }, static_cast<std::uint32_t>(options.bit_rate)},
                   sheet, other, ranges, &held->refusal());
  }
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  code = options.restore.empty() ? may_read(*bus, options) : must_be_idle(*bus, "`od --restore`", options);
  if (code != kDone) return bus->finish(code);
  return bus->finish(
      work_on({options, *bus, [&] { return bus->over(); }, bus->bit_rate()}, sheet, other, ranges, nullptr));
}

}  // namespace servogate::gateway::command
