// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/od_parameters.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/object_restore.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::address_text;
using canopen::Difference;
using canopen::FailedWrite;
using canopen::ObjectCatalogue;
using canopen::show_value;
using nlohmann::json;

const text::Entry kOtherNode{
    "od.other-node", "{0} is the configuration of node {1}; its COB-IDs are taken for those of node {2}",
    "{0} — настройка узла {1}; её COB-ID приняты для узла {2}"};
const text::Entry kEqual{"od.equal", "node {0} is as {1} has it: {2} parameters compared",
                         "узел {0} соответствует {1}: сравнено параметров: {2}"};
const text::Entry kDiffers{"od.differs", "{0}: the device has {1}, the file {2}",
                           "{0}: в устройстве {1}, в файле {2}"};
const text::Entry kMany{"od.differences", "{0} of {1} parameters differ from {2}",
                        "параметров, отличных от {2}: {0} из {1}"};
const text::Entry kOtherDevice{
    "od.other-device", "{0} is of another device: its {1} is {2}, node {3} has {4}; nothing was written",
    "{0} — от другого устройства: {1} в файле {2}, у узла {3} — {4}; ничего не записано"};
const text::Entry kOtherSerial{"od.other-serial",
                               "{0} is of the device with the serial number {1}, node {3} has {2}; nothing "
                               "was written. If node {3} takes "
                               "the place of that device, add --anyway",
                               "{0} — от устройства с заводским номером {1}, у узла {3} — {2}; ничего не "
                               "записано. Если узел {3} заменяет "
                               "то устройство, добавьте --anyway"};
const text::Entry kSuccessor{
    "od.successor",
    "{0} is of the device with the serial number {1}, this one has {2}: its parameters are taken",
    "{0} — от устройства с заводским номером {1}, у этого {2}: параметры берутся"};
const text::Entry kRestored{"od.restored", "{0} parameters of node {1} written",
                            "записано параметров узла {1}: {0}"};
const text::Entry kRefused{"od.refused", "{0} is not written: {1}", "{0}: не записано, {1}"};

std::string got_words(const Difference& d) {
  return d.outcome.ok() ? show_value(d.outcome.data, d.type) : d.outcome.why();
}

json rows_of(const std::vector<Difference>& found, const ObjectCatalogue& catalogue) {
  json list = json::array();
  for (const Difference& d : found) {
    json row = place_json(catalogue, d.index, d.subindex);
    row["device"] = got_words(d);
    row["file"] = d.wanted;
    list.push_back(std::move(row));
  }
  return list;
}

void print_rows(const std::vector<Difference>& found, const ObjectCatalogue& catalogue) {
  for (const Difference& d : found)
    print_line(say(kDiffers, {place_words(catalogue, d.index, d.subindex), got_words(d), d.wanted}));
}

int say_of_which_node(const OdWork& work, const std::string& path, const canopen::Eds& file) {
  const int of = file.commissioning ? file.commissioning->node : 0;
  if (of != 0 && of != work.options.node)
    complain(kOtherNode, {path, std::to_string(of), std::to_string(work.options.node)});
  return of;
}

/// The identity in which the file is of another device; nullptr: it may be of this one.
const Difference* other_device(const std::vector<Difference>& found) {
  for (const Difference& d : found)
    if (d.index == canopen::object::kIdentity && (d.subindex == 1 || d.subindex == 2)) return &d;
  return nullptr;
}

bool is_serial_number(const Difference& d) {
  return d.index == canopen::object::kIdentity && d.subindex == 4;
}

/// The serial number is no parameter: the file of a device that was replaced is for its successor.
void take_serial_number_out(std::vector<Difference>& found) { std::erase_if(found, is_serial_number); }

}  // namespace

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

std::string place_words(const ObjectCatalogue& catalogue, std::uint16_t index, std::uint8_t subindex) {
  const std::string name = catalogue.name(index, subindex);
  return address_text(index, subindex) + (name.empty() ? "" : " " + name);
}

json place_json(const ObjectCatalogue& catalogue, std::uint16_t index, std::uint8_t subindex) {
  char digits[8];
  std::snprintf(digits, sizeof digits, "%04X", index);
  return {{"index", digits}, {"subindex", subindex}, {"name", catalogue.name(index, subindex)}};
}

json head(const OdOptions& options) { return {{"schema", 1}, {"node", options.node}}; }
void print_json(const json& out) { print_exact(out.dump(1, ' ', false, json::error_handler_t::replace)); }

int compare_parameters(const OdWork& work, const canopen::Eds& file) {
  const std::string& path = work.options.compare;
  const int of = say_of_which_node(work, path, file);
  int compared = 0;
  const std::vector<Difference> found =
      canopen::differences(work.access, work.node(), file, compared, work.over);
  const ObjectCatalogue catalogue(&file);
  if (work.options.json) {
    json out = head(work.options);
    out["compared"] = compared;
    if (of != 0) out["file_node"] = of;
    out["differences"] = rows_of(found, catalogue);
    print_json(out);
  } else if (found.empty()) {
    print_line(say(kEqual, {std::to_string(work.options.node), path, std::to_string(compared)}));
  } else {
    print_rows(found, catalogue);
    complain(kMany, {std::to_string(found.size()), std::to_string(compared), path});
  }
  return found.empty() ? kDone : kAlarm;
}

int restore_parameters(const OdWork& work, const canopen::Eds& file) {
  const std::string& path = work.options.restore;
  say_of_which_node(work, path, file);
  int compared = 0;
  auto before = canopen::differences(work.access, work.node(), file, compared, work.over);
  const ObjectCatalogue catalogue(&file);
  if (const Difference* d = other_device(before)) {
    complain(kOtherDevice, {path, place_words(catalogue, d->index, d->subindex), d->wanted,
                            std::to_string(work.options.node), got_words(*d)});
    return kAlarm;
  }
  if (const auto d = std::find_if(before.begin(), before.end(), is_serial_number); d != before.end()) {
    complain(work.options.anyway ? kSuccessor : kOtherSerial,
             {path, d->wanted, got_words(*d), std::to_string(work.options.node)});
    if (!work.options.anyway) return kAlarm;
  }
  take_serial_number_out(before);
  if (!work.options.json) print_rows(before, catalogue);
  std::vector<FailedWrite> failed;
  const int written = canopen::restore(work.access, work.node(), file, before, failed, work.over);
  auto after = canopen::differences(work.access, work.node(), file, compared, work.over);
  take_serial_number_out(after);
  if (work.over()) return kInfrastructure;
  if (work.options.json) {
    json out = head(work.options);
    out["compared"] = compared;
    out["written"] = written;
    out["before"] = rows_of(before, catalogue);
    out["after"] = rows_of(after, catalogue);
    out["refused"] = json::array();
    for (const FailedWrite& f : failed) {
      json row = place_json(catalogue, f.index, f.subindex);
      row["error"] = f.outcome.why();
      out["refused"].push_back(std::move(row));
    }
    print_json(out);
  } else {
    print_line(say(kRestored, {std::to_string(written), std::to_string(work.options.node)}));
    if (after.empty())
      print_line(say(kEqual, {std::to_string(work.options.node), path, std::to_string(compared)}));
  }
  keep_order();
  for (const FailedWrite& f : failed)
    complain(kRefused, {place_words(catalogue, f.index, f.subindex), f.outcome.why()});
  if (after.empty()) return kDone;
  if (!work.options.json) print_rows(after, catalogue);
  complain(kMany, {std::to_string(after.size()), std::to_string(compared), path});
  return kAlarm;
}

}  // namespace servogate::gateway::command
