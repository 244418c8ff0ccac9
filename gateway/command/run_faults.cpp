// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/run_faults.hpp"

#include <algorithm>

#include "gateway/cli/messages.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kWrong{"run.fault-wrong", "{0}: {1}", "{0}: {1}"};
const text::Entry kNoTarget{
    "run.fault-target", "{0}: name what it happens to: node=N of a bus, or device=NAME of the machine file",
    "{0}: укажите, с чем это происходит: node=N узла шины или device=ИМЯ из файла станка"};
const text::Entry kNoNode{"run.fault-node", "{0}: no bus of the machine file has a node {1}",
                          "{0}: ни на одной шине файла станка нет узла {1}"};
const text::Entry kNoDeed{"run.fault-deed", "{0}: only faults and `clear` are possible here",
                          "{0}: здесь возможны только неисправности и `clear`"};
const text::Entry kNotReadable{"run.script-unreadable", "{0} cannot be read: {1}", "{0} не читается: {1}"};
const text::Entry kNotDone{"run.fault-not-done", "at {0} s `{1}` could not happen: {2}",
                           "в {0} с «{1}» не произошло: {2}"};

/// "bus.node" of a node-ID, the first bus that has it; empty: none.
std::string node_name(const machine::MachineConfig& m, int id) {
  for (const machine::BusConfig& bus : m.buses)
    for (const machine::NodeConfig& node : bus.nodes)
      if (node.id == id) return bus.name + "." + node.name;
  return {};
}

}  // namespace

bool RunFaults::add(const DriveDeed& deed, const std::string& place) {
  using Kind = DriveDeed::Kind;
  const auto refuse = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), place);
    complain(entry, arguments);
    return false;
  };
  if (deed.kind != Kind::fault && deed.kind != Kind::clear && deed.kind != Kind::clear_all)
    return refuse(kNoDeed, {});
  if (deed.device.empty() && deed.node == 0) return refuse(kNoTarget, {});
  const std::string device = deed.device.empty() ? node_name(machine_.machine(), deed.node) : deed.device;
  if (device.empty()) return refuse(kNoNode, {std::to_string(deed.node)});
  std::string why;
  if (!machine_.control().faults().possible(device, deed.kind == Kind::fault ? &deed.fault : nullptr, why))
    return refuse(kWrong, {why});
  due_.push_back({deed.at, device, deed.words, deed});
  return true;
}

bool RunFaults::plan(const std::vector<std::string>& lines, const std::string& script) {
  bool good = true;
  for (const std::string& line : lines) {
    std::string why;
    const auto deed = parse_deed(line, why);
    const std::string place = "--fault \"" + line + "\"";
    if (!deed) {
      complain(kWrong, {place, why});
      good = false;
    } else {
      good = add(*deed, place) && good;
    }
  }
  if (!script.empty()) {
    std::string why;
    const auto text = files::read_file(script, files::kMostOfSettings, why);
    if (!text) {
      complain(kNotReadable, {script, why});
      return false;
    }
    int number = 0;
    const auto deeds = parse_script(*text, number, why);
    if (!deeds) {
      complain(kWrong, {script + ":" + std::to_string(number), why});
      return false;
    }
    for (const DriveDeed& deed : *deeds) good = add(deed, script + ": " + deed.words) && good;
  }
  std::stable_sort(due_.begin(), due_.end(), [](const Due& a, const Due& b) { return a.at < b.at; });
  return good;
}

bool RunFaults::take(const std::string& line, image::Nanoseconds now) {
  if (line.find_first_not_of(" \t\r") == std::string::npos) return true;
  std::string why;
  auto deed = parse_deed(line, why);
  if (!deed) {
    complain(kWrong, {line, why});
    return false;
  }
  deed->at += now;
  if (!add(*deed, line)) return false;
  std::stable_sort(due_.begin() + static_cast<std::ptrdiff_t>(done_), due_.end(),
                   [](const Due& a, const Due& b) { return a.at < b.at; });
  return true;
}

void RunFaults::poll(image::Nanoseconds now) {
  using Kind = DriveDeed::Kind;
  for (; done_ < due_.size() && due_[done_].at <= now; ++done_) {
    const Due& d = due_[done_];
    std::string why;
    const bool done = d.deed.kind == Kind::fault   ? machine_.inject(d.device, d.deed.fault, why)
                      : d.deed.kind == Kind::clear ? machine_.clear(d.device, d.deed.fault.kind, why)
                                                   : machine_.clear(d.device, std::nullopt, why);
    if (!done) complain(kNotDone, {text::number(static_cast<double>(d.at) * 1e-9, 3), d.words, why});
  }
}

}  // namespace servogate::gateway::command
