// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/played_input.hpp"

#include "gateway/control/compose/simulated/played_value.hpp"

namespace servogate::gateway {

namespace {

using text::Entry;
using Outcome = PlayedInput::Outcome;

// {0} is always the point.
const Entry kNoPoint{"input.no-point", "the machine has no input '{0}'; it has {1}",
                     "у станка нет входа «{0}»; есть {1}"};
const Entry kOutput{"input.output", "'{0}' is an output: the PLC drives it, not the world",
                    "«{0}» — выход: им управляет ПЛК, а не внешний мир"};
const Entry kRealPoint{
    "input.real-point",
    "'{0}' is a real input (station '{1}', {2}): only inputs of mock stations can be played",
    "«{0}» — настоящий вход (станция «{1}», {2}): разыгрывать можно только входы имитаций"};
const Entry kAnalogPoint{"input.analog-point", "'{0}' is analog: give it a number, not on or off",
                         "«{0}» — аналоговый вход: нужно число, а не on или off"};
const Entry kDigitalPoint{"input.digital-point", "'{0}' is on or off (1 or 0), not {1}",
                          "«{0}» — вход on или off (1 или 0), а не {1}"};
const Entry kRange{"input.range", "'{0}' cannot be {1}: from {2} to {3} is possible",
                   "«{0}» не может быть {1}: возможно от {2} до {3}"};
const Entry kSteps{"input.steps", "'{0}' cannot be {1}: its register holds {2} or {3}",
                   "«{0}» не может быть {1}: регистр вмещает {2} или {3}"};
const Entry kFollowsNothing{
    "input.follows-nothing",
    "'{0}' follows nothing by itself: `auto` is for switches that axes operate and for "
    "inputs that an output operates",
    "«{0}» ни за чем не следит: `auto` — для выключателей, которыми управляют оси, и для "
    "входов, которыми управляют выходы"};
const Entry kNoControl{"input.no-control", "the pendant has no '{0}'; it has {1}",
                       "у пульта нет «{0}»; есть {1}"};
const Entry kIs{"input.is", "input {0} is {1}", "вход {0}: {1}"};
const Entry kFollows{"input.follows", "input {0} follows its axis or its output again",
                     "вход {0} снова следует за осью или за выходом"};

PlayedInput refused(Outcome outcome, const Entry& entry, std::vector<std::string> arguments) {
  return {outcome, &entry, std::move(arguments), std::nullopt};
}

std::string inputs_of(const machine::MachineConfig& machine) {
  std::string list;
  for (const machine::StationConfig& s : machine.stations)
    for (const machine::PointConfig& p : s.points)
      if (p.is_input() && s.mock()) list += (list.empty() ? "" : ", ") + p.name;
  return list;
}

/// The value that the point will have; nothing with `why`: it can have none like this.
std::optional<double> value_for(const machine::PointConfig& point, const InputWish& wish, PlayedInput& why) {
  const auto wrong = [&](const Entry& entry, std::vector<std::string> arguments) {
    why = refused(Outcome::wrong, entry, std::move(arguments));
    return std::nullopt;
  };
  const bool* level = std::get_if<bool>(&wish);
  if (point.is_analog() && level != nullptr) return wrong(kAnalogPoint, {point.name});
  const double value = level != nullptr ? (*level ? 1.0 : 0.0) : std::get<double>(wish);
  const image::NumberRange range = range_of(point);
  const bool inside = value >= range.min && value <= range.max;
  if (inside && point.is_analog()) {
    const auto [below, above] = next_to(point, value);
    const bool fits = below == value || above == value;
    if (is_whole(point) && !fits)
      return wrong(kSteps, {point.name, text::number(value), text::number(below), text::number(above)});
    return above - value > value - below ? below : above;
  }
  if (inside && (value == range.min || value == range.max)) return value;
  if (!point.is_analog()) return wrong(kDigitalPoint, {point.name, text::number(value)});
  return wrong(kRange, {point.name, text::number(value), text::number(range.min), text::number(range.max)});
}

/// Turns the wheel or presses a button of a simulated pendant: "pendant.wheel".
PlayedInput play_pendant(mock::MockPendant& pendant, const std::string& name, const InputWish& wish) {
  const std::string control = name.substr(name.find('.') + 1);
  if (std::holds_alternative<std::monostate>(wish)) return refused(Outcome::wrong, kFollowsNothing, {name});
  const bool* level = std::get_if<bool>(&wish);
  const double value = level != nullptr ? (*level ? 1.0 : 0.0) : std::get<double>(wish);
  switch (pendant.play(control, value)) {
    case mock::MockPendant::Played::done:
      return {Outcome::done, &kIs, {name, text::number(value)}, value};
    case mock::MockPendant::Played::no_such_control: {
      std::string list;
      for (const std::string& c : pendant.controls()) list += (list.empty() ? "" : ", ") + c;
      return refused(Outcome::wrong, kNoControl, {name, list});
    }
    case mock::MockPendant::Played::out_of_range:
      break;
  }
  const auto [least, most] = pendant.range(control);
  return refused(Outcome::wrong, kRange,
                 {name, text::number(value), text::number(least), text::number(most)});
}

}  // namespace

PlayedInput play_input(const machine::MachineConfig& machine, mock::World& world, const std::string& name,
                       const InputWish& wish) {
  const std::size_t dot = name.find('.');
  if (dot != std::string::npos)
    if (mock::MockPendant* const pendant = world.pendant(name.substr(0, dot)))
      return play_pendant(*pendant, name, wish);
  int station = -1;
  const machine::PointConfig* point = machine.point(name, &station);
  if (point == nullptr) return refused(Outcome::wrong, kNoPoint, {name, inputs_of(machine)});
  if (!point->is_input()) return refused(Outcome::wrong, kOutput, {name});
  const machine::StationConfig& s = machine.stations[static_cast<std::size_t>(station)];
  PlayedInput played = refused(Outcome::not_simulated, kRealPoint, {name, s.name, s.url});
  if (!s.mock()) return played;
  std::optional<double> value;
  if (!std::holds_alternative<std::monostate>(wish)) {
    value = value_for(*point, wish, played);
    if (!value) return played;
  }
  switch (world.play_input(name, {value})) {
    case mock::World::Played::follows_nothing:
      return refused(Outcome::wrong, kFollowsNothing, {name});
    case mock::World::Played::no_such_input:
      return played;
    case mock::World::Played::done:
      break;
  }
  if (!value) return {Outcome::done, &kFollows, {name}, std::nullopt};
  const std::string shown = point->is_analog() ? text::number(*value) : *value != 0.0 ? "on" : "off";
  return {Outcome::done, &kIs, {name, shown}, value};
}

}  // namespace servogate::gateway
