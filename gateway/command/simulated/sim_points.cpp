// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/sim_points.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/simulated/fault_line.hpp"
#include "gateway/control/compose/simulated/played_input.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kPoint{"sim.point", "{0} {1}", "{0} {1}"};
const text::Entry kNoInput{"sim.bad-input", "'{0}': expected input POINT on|off|auto|NUMBER",
                           "«{0}»: нужно input ТОЧКА on|off|auto|ЧИСЛО"};
const text::Entry kOfDrives{"sim.no-input", "{0}; inputs of the drives are {1}", "{0}; входы приводов: {1}"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

double seconds(image::Nanoseconds time) { return static_cast<double>(time) / 1e9; }

/// nullopt: no level.
std::optional<InputWish> wish_of(const std::string& word) {
  if (word == "on" || word == "off") return word == "on";
  if (word == "auto") return InputWish{};
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0' || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace

SimPoints::SimPoints(const machine::MachineConfig& machine, mock::World& world, bool json)
    : machine_(machine), world_(world), json_(json) {
  for (const machine::SimulatedSwitch& s : machine.simulation.switches)
    if (const int axis = machine.axis_index(s.axis); axis >= 0)
      switches_.push_back({s, axis, false, std::nullopt});
}

void SimPoints::look(image::Nanoseconds since_start) {
  for (Switch& row : switches_) {
    if (row.held) continue;
    const double at = world_.axis_position(row.axis);
    const bool on = at >= row.config.from && at <= row.config.to;
    if (row.told == on) continue;
    row.told = on;
    if (json_)
      print_json_line({{"event", "switch"},
                       {"t", seconds(since_start)},
                       {"point", row.config.point},
                       {"on", on},
                       {"axis", row.config.axis},
                       {"position", at}});
    else
      print_line(say(kPoint, {row.config.point, on ? "on" : "off"}));
    keep_order();
  }
}

bool SimPoints::play(const std::string& line, image::Nanoseconds since_start) {
  std::istringstream words(line);
  std::string verb, point, level, more;
  words >> verb >> point >> level >> more;
  const bool of_machine = machine_.point(point) != nullptr;
  if (verb != "input" || (!of_machine && drive_input(point))) return false;
  const auto wish = wish_of(level);
  if (point.empty() || !wish || !more.empty()) return complain(kNoInput, {line}), true;
  const PlayedInput played = play_input(machine_, world_, point, *wish);
  const std::string said = say(*played.entry, played.arguments);
  if (played.outcome != PlayedInput::Outcome::done) {
    if (of_machine)
      complain(*played.entry, played.arguments);
    else
      complain(kOfDrives, {said, drive_input_names()});
    return true;
  }
  for (Switch& row : switches_)
    if (row.config.point == point) {
      row.held = played.value.has_value();
      row.told.reset();
    }
  if (json_)
    print_json_line({{"event", "input"},
                     {"t", seconds(since_start)},
                     {"point", point},
                     {"played", played.value ? json(*played.value) : json("auto")}});
  else
    print_line(said);
  keep_order();
  return true;
}

}  // namespace servogate::gateway::command
