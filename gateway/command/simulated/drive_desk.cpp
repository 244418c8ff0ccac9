// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/drive_desk.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kBadDeed{"drive.bad-fault", "{0}: {1}", "{0}: {1}"};
const text::Entry kBadScript{"drive.bad-script", "{0}:{1}: {2}", "{0}:{1}: {2}"};
const text::Entry kCannotRead{"drive.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};
const text::Entry kHappened{"drive.happened", "node {0}: {1}", "узел {0}: {1}"};
const text::Entry kOnDevice{"drive.on-device", "{0}", "{0}"};
const text::Entry kNoMachine{"drive.no-machine",
                             "device={0} is a name of a machine file: `servogate sim` has them; here node=N",
                             "device={0} — имя из файла станка: они есть у `servogate sim`; здесь node=N"};
const text::Entry kNobody{"drive.nobody", "no drive of this process has the node-ID {0}",
                          "у этого процесса нет привода с номером узла {0}"};

constexpr const char* kStates[] = {
    "offline",     "not_ready_to_switch_on", "switch_on_disabled", "ready_to_switch_on",
    "switched_on", "operation_enabled",      "quick_stop_active",  "fault_reaction_active",
    "fault"};

json status_of(mock::SimulatedDrive& d) {
  char code[8];
  std::snprintf(code, sizeof code, "%04X", d.error_code());
  return {{"event", "status"},
          {"node", d.node_id()},
          {"state", kStates[static_cast<int>(d.state())]},
          {"nmt", static_cast<int>(d.nmt_state())},
          {"statusword", d.statusword()},
          {"error_code", code},
          {"position", d.reported_position()},
          {"revolutions", d.revolutions()},
          {"velocity_counts_s", d.velocity_counts_s()},
          {"torque_permille", d.torque_permille()},
          {"thermal", d.thermal()},
          {"brake_released", d.brake_released()}};
}

void perform_on(mock::SimulatedDrive& d, const DriveDeed& deed) {
  switch (deed.kind) {
    case DriveDeed::Kind::fault:
      return d.inject(deed.fault);
    case DriveDeed::Kind::clear:
      return d.clear(deed.fault.kind);
    case DriveDeed::Kind::clear_all:
      return d.clear_faults();
    case DriveDeed::Kind::input:
      return d.set_input(deed.input, deed.on);
    case DriveDeed::Kind::load:
      return d.set_load_torque(deed.load_nm);
    case DriveDeed::Kind::status:
      return print_json_line(status_of(d));
  }
}

double seconds(image::Nanoseconds time) { return static_cast<double>(time) / 1e9; }

bool later(const DriveDeed& a, const DriveDeed& b) { return a.at < b.at; }

}  // namespace

std::optional<std::vector<DriveDeed>> read_deeds(const FaultOptions& options, std::span<const int> nodes) {
  std::vector<DriveDeed> deeds;
  std::string why;
  for (const std::string& line : options.faults) {
    auto deed = parse_deed(line, why);
    if (!deed) {
      complain(kBadDeed, {"--fault", why});
      return std::nullopt;
    }
    deeds.push_back(std::move(*deed));
  }
  if (!options.script.empty()) {
    const auto text = files::read_file(options.script, files::kMostOfSettings, why);
    if (!text) {
      complain(kCannotRead, {options.script, why});
      return std::nullopt;
    }
    int number = 0;
    auto script = parse_script(*text, number, why);
    if (!script) {
      complain(kBadScript, {options.script, std::to_string(number), why});
      return std::nullopt;
    }
    deeds.insert(deeds.end(), script->begin(), script->end());
  }
  for (const DriveDeed& d : deeds)
    if (d.node != 0 && d.at == 0 && std::find(nodes.begin(), nodes.end(), d.node) == nodes.end()) {
      complain(kNobody, {std::to_string(d.node)});
      return std::nullopt;
    }
  std::stable_sort(deeds.begin(), deeds.end(), later);
  return deeds;
}

DriveDesk::DriveDesk(std::vector<DriveDeed> script, bool listening, bool json)
    : waiting_(std::move(script)), input_(listening), json_(json) {}

void DriveDesk::take(const std::string& line, image::Nanoseconds since_start,
                     const std::function<bool(const std::string&)>& other) {
  if (line.find_first_not_of(" \t\r") == std::string::npos || (other && other(line))) return;
  std::string why;
  auto deed = parse_deed(line, why);
  if (!deed) return complain(kBadDeed, {line, why});
  // A time in a line that is typed counts from now.
  deed->at += since_start;
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), *deed, later), *deed);
}

void DriveDesk::advance(image::Nanoseconds since_start, std::span<mock::SimulatedDrive* const> drives,
                        const std::function<bool(const std::string&)>& other) {
  while (const auto line = input_.next()) take(*line, since_start, other);
  while (!waiting_.empty() && waiting_.front().at <= since_start) {
    const DriveDeed deed = waiting_.front();
    waiting_.erase(waiting_.begin());
    perform(deed, since_start, drives);
  }
}

void DriveDesk::perform_on_device(const DriveDeed& deed, image::Nanoseconds since_start) {
  std::string why;
  if (!on_device_) return complain(kNoMachine, {deed.device});
  if (!on_device_(deed, why)) return complain(kBadDeed, {deed.words, why});
  tell(text::render(kOnDevice, std::vector<std::string>{deed.words}, text::user_language()));
  if (json_)
    print_json_line(
        {{"event", "done"}, {"t", seconds(since_start)}, {"device", deed.device}, {"what", deed.words}});
}

void DriveDesk::perform(const DriveDeed& deed, image::Nanoseconds since_start,
                        std::span<mock::SimulatedDrive* const> drives) {
  if (!deed.device.empty()) return perform_on_device(deed, since_start);
  bool found = false;
  for (mock::SimulatedDrive* d : drives) {
    if (deed.node != 0 && deed.node != d->node_id()) continue;
    found = true;
    if (deed.kind != DriveDeed::Kind::status) {
      tell(text::render(kHappened, std::vector<std::string>{std::to_string(d->node_id()), deed.words},
                        text::user_language()));
      if (json_)
        print_json_line(
            {{"event", "done"}, {"t", seconds(since_start)}, {"node", d->node_id()}, {"what", deed.words}});
    }
    perform_on(*d, deed);
  }
  if (!found) complain(kNobody, {std::to_string(deed.node)});
}

}  // namespace servogate::gateway::command
