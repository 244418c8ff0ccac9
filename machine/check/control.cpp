// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "kernel/program/interpreter/interpreter.hpp"
#include "kernel/program/languages/languages.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

void check_buses(const MachineConfig& machine, Reading& reading) {
  if (machine.buses.size() > static_cast<std::size_t>(image::kMaxSegments))
    reading.error(machine.where("bus." + std::to_string(image::kMaxSegments)), finding::kTooMany,
                  {std::to_string(machine.buses.size()), text::both("buses", "Шин слишком много"),
                   std::to_string(image::kMaxSegments)});
  for (std::size_t i = 0; i < machine.buses.size(); ++i) {
    const BusConfig& bus = machine.buses[i];
    const std::string path = "bus." + std::to_string(i);
    if (!bus.url.empty() && !is_can_url(bus.url))
      reading.error(
          machine.where(path + ".url"), finding::kBadUrl,
          {"url", bus.url,
           text::both("mock:NAME, socketcan:IF, socketcand:HOST:PORT/NAME, socketcand:unix:PATH/NAME, "
                      "lockstep:HOST:PORT/NAME, udp:GROUP:PORT, gsusb:SERIAL, slcan:PATH",
                      "mock:ИМЯ, socketcan:IF, socketcand:ХОСТ:ПОРТ/ИМЯ, socketcand:unix:ПУТЬ/ИМЯ, "
                      "lockstep:ХОСТ:ПОРТ/ИМЯ, udp:ГРУППА:ПОРТ, gsusb:СЕРИЙНЫЙ, slcan:ПУТЬ")});
    const bool known = std::any_of(std::begin(kBitRates), std::end(kBitRates),
                                   [&](int k) { return bus.bit_rate == std::int64_t{k} * 1000; });
    if (bus.bit_rate != 0 && !known)
      reading.error(machine.where(path + ".bit_rate"), finding::kBitRate,
                    {std::to_string(bus.bit_rate), "10, 20, 50, 125, 250, 500, 800, 1000"});
  }
}

class StationCheck {
 public:
  StationCheck(const MachineConfig& machine, std::size_t index, Reading& reading)
      : machine_(machine),
        s_(machine.stations[index]),
        path_("station." + std::to_string(index) + "."),
        reading_(reading) {
    kind_ = std::string(choices_of<StationKind>()[static_cast<std::size_t>(s_.kind)]);
  }

  void all() {
    if (!machine_.places.contains(path_ + "kind")) return;  // unknown kind: said by the reader
    if (s_.over_bus()) {
      needed("node", s_.node);
      not_here("url", s_.url);
      not_here("device", s_.device);
    } else {
      not_here("node", s_.node);
    }
    const bool board = s_.kind == StationKind::board;
    if (s_.kind == StationKind::gpio || board) needed("url", s_.url);
    if (board) not_here("device", s_.device);
    if (!board && machine_.places.contains(path_ + "watchdog"))
      reading_.error(machine_.where(path_ + "watchdog"), finding::kKeyNotHere, {"watchdog", kind_});
    if (s_.kind == StationKind::modbus) modbus();
    if (s_.kind != StationKind::modbus) not_here("line", s_.line);
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.points[i].debounce > 0.0 && s_.points[i].channel != ChannelKind::di)
        reading_.error(machine_.where(path_ + "points." + std::to_string(i) + ".debounce"),
                       finding::kDebounceKind, {s_.points[i].channel_text});
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.points[i].hysteresis > 0.0 && s_.points[i].channel != ChannelKind::ai)
        reading_.error(machine_.where(path_ + "points." + std::to_string(i) + ".hysteresis"),
                       finding::kHysteresisKind, {s_.points[i].channel_text});
    if (s_.kind == StationKind::modbus || s_.kind == StationKind::canopen || board) return;
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.points[i].is_analog() && !(s_.kind == StationKind::gpio && s_.points[i].is_encoder()))
        reading_.error(machine_.where(path_ + "points." + std::to_string(i) + ".channel"),
                       finding::kAnalogOnGpio, {s_.points[i].channel_text, kind_});
  }

 private:
  void modbus() {
    needed("device", s_.device);
    if (machine_.places.contains(path_ + "url"))
      return reading_.error(machine_.where(path_ + "url"), finding::kStationUrl, {s_.url, s_.name});
    needed("line", s_.line);
    if (s_.line.empty()) return;
    if (machine_.line(s_.line) == nullptr)
      return reading_.error(machine_.where(path_ + "line"), finding::kNoLine, {s_.line});
    for (const StationConfig& other : machine_.stations) {
      if (&other == &s_) return;
      if (other.kind == StationKind::modbus && other.line == s_.line && other.unit == s_.unit)
        return reading_.error(machine_.where(path_ + "unit"), finding::kUnitTwice,
                              {std::to_string(s_.unit), s_.line, other.name});
    }
  }
  void needed(const std::string& key, const std::string& value) {
    if (value.empty()) reading_.error(machine_.where(path_ + "kind"), finding::kKeyNeeded, {key, kind_});
  }
  void not_here(const std::string& key, const std::string& value) {
    if (!value.empty()) reading_.error(machine_.where(path_ + key), finding::kKeyNotHere, {key, kind_});
  }

  const MachineConfig& machine_;
  const StationConfig& s_;
  std::string path_;
  Reading& reading_;
  std::string kind_;
};

void check_simulation(const MachineConfig& machine, Reading& reading) {
  for (std::size_t i = 0; i < machine.simulation.switches.size(); ++i) {
    const SimulatedSwitch& s = machine.simulation.switches[i];
    const Where at = machine.where("simulation.switch." + std::to_string(i));
    if (!std::isfinite(s.from) && !std::isfinite(s.to))
      reading.error(at, finding::kSwitchZoneMissing, {s.point});
    else if (s.from >= s.to)
      reading.error(at, finding::kSwitchZone, {s.point, text::number(s.from), text::number(s.to)});
  }
}

/// "home.switch of X" where an axis has the point as one of its switches; empty: none has.
std::string switch_of_axis(const MachineConfig& machine, const std::string& point) {
  for (const AxisConfig& a : machine.axes)
    for (const auto& [key, name] : {std::pair{"limit_plus", &a.limit_plus},
                                    {"limit_minus", &a.limit_minus},
                                    {"home.switch", &a.home.switch_point}})
      if (*name == point) return text::both(std::string(key) + " of ", std::string(key) + " оси ") + a.letter;
  return {};
}

void check_estop(const MachineConfig& machine, Reading& reading) {
  if (machine.safety.estop.empty()) {
    reading.warning(machine.where("safety"), finding::kNoEstop, {});
    return;
  }
  int station = -1;
  const PointConfig* point = machine.point(machine.safety.estop, &station);
  if (point == nullptr) return;
  const StationConfig& s = machine.stations[static_cast<std::size_t>(station)];
  const Where at = machine.where("safety.estop");
  if (s.kind == StationKind::modbus) reading.error(at, finding::kEstopModbus, {point->name, s.name});
  if (const std::string taken = switch_of_axis(machine, point->name); !taken.empty())
    reading.error(at, finding::kEstopShared, {point->name, taken});
  if (point->inverted) reading.error(at, finding::kEstopInverted, {point->name});
  if (point->loss != 0.0 || point->hold) reading.error(at, finding::kEstopLoss, {point->name});
}

/// A switch that no wire can open does not guard a drive that is real.
void check_mock_guards(const MachineConfig& machine, Reading& reading) {
  const auto guard = [&](const std::string& path, const std::string& name, const std::string& carrier) {
    int station = -1;
    const PointConfig* point = machine.point(name, &station);
    if (point == nullptr) return;
    const StationConfig& s = machine.stations[static_cast<std::size_t>(station)];
    if (machine.nothing_real(s))
      reading.error(machine.where(path), finding::kMockGuard, {name, s.name, carrier});
  };
  // What is real and moves something, empty: nothing.
  const auto bus_words = [](const BusConfig& b) {
    return b.nothing_real() ? std::string() : text::both("bus \"" + b.name + "\"", "шина «" + b.name + "»");
  };
  const auto board_words = [](const StationConfig& s) {
    return s.kind != StationKind::board || s.mock()
               ? std::string()
               : text::both("board \"" + s.name + "\"", "плата «" + s.name + "»");
  };
  std::string real;
  for (const BusConfig& b : machine.buses)
    if (real.empty()) real = bus_words(b);
  for (const StationConfig& s : machine.stations)
    if (real.empty()) real = board_words(s);
  if (real.empty()) return;
  if (machine.safety.mock_inputs_guard_real_drives)
    return reading.warning(machine.where("safety.mock_inputs_guard_real_drives"), finding::kMockGuardDeclared,
                           {});
  guard("safety.estop", machine.safety.estop, real);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const AxisConfig& a = machine.axes[i];
    int bus = -1;
    std::string carrier;
    if (machine.node(a.drive, &bus) != nullptr)
      carrier = bus_words(machine.buses[static_cast<std::size_t>(bus)]);
    for (const StationConfig& s : machine.stations)
      if (s.name == a.board.station) carrier = board_words(s);
    if (carrier.empty()) continue;
    const std::string path = "axis." + std::to_string(i);
    guard(path + ".limit_plus", a.limit_plus, carrier);
    guard(path + ".limit_minus", a.limit_minus, carrier);
  }
}

/// The power-on modes and values, as the interpreter of the language will read them.
void check_settings(const MachineConfig& machine, Reading& reading) {
  program::MachineModel model;
  for (const AxisConfig& a : machine.axes)
    model.axes.push_back({.letter = a.letter, .rotary = a.type == AxisType::rotary, .diameter = a.diameter});
  for (const OwnCodeConfig& c : machine.own_codes) model.own_codes.push_back({c.code, c.program, c.words});
  model.kind = static_cast<program::MachineModel::Kind>(machine.control.kind);
  model.power_on = machine.control.power_on;
  model.variables = machine.control.variables;
  const program::Interpreter reader(machine.control.dialect, std::move(model), {}, {}, {}, {}, {});
  for (const program::SettingFault& fault : reader.setting_faults()) {
    const std::string path = fault.own_code >= 0 ? "own_code." + std::to_string(fault.own_code)
                             : fault.mode >= 0   ? "control.power_on." + std::to_string(fault.mode)
                                                 : "control.variables." + fault.variable;
    reading.error(machine.where(path), *fault.entry, fault.arguments);
  }
}

}  // namespace

void check_safety(const MachineConfig& machine, Reading& reading) {
  check_estop(machine, reading);
  const bool broken = std::any_of(reading.findings.begin(), reading.findings.end(),
                                  [](const text::Finding& f) { return f.severity == text::Severity::error; });
  if (broken || machine.nothing_real()) return;  // a transport that cannot be read says nothing about the bus
  check_mock_guards(machine, reading);
  if (machine.run.start_point.empty()) reading.warning(machine.where("run"), finding::kNoStartPoint, {});
  if (machine.run.allow_start_now)
    reading.warning(machine.where("run.allow_start_now"), finding::kStartNow, {});
}

void check_control(const MachineConfig& machine, Reading& reading) {
  // The steps of 60C2h with base 10^-3 and 10^-4 that drives have in common.
  static constexpr std::int64_t kStepNs = 250'000;
  if (machine.cycle_ns() % kStepNs != 0)
    reading.error(machine.where("control.cycle_time"), finding::kCycleStep,
                  {text::number(machine.control.cycle_time * 1000.0), std::to_string(kStepNs / 1000)});
  const std::vector<std::string> dialects = program::dialects();
  if (std::find(dialects.begin(), dialects.end(), machine.control.dialect) != dialects.end()) {
    check_settings(machine, reading);
  } else {
    std::string known;
    for (const std::string& dialect : dialects) known += (known.empty() ? "" : ", ") + dialect;
    reading.error(machine.where("control.dialect"), finding::kUnknownDialect,
                  {machine.control.dialect, known});
  }
  const auto latch = static_cast<std::size_t>(machine.control.probe_latch);
  if (machine.control.probe_latch != ProbeLatch::edge && machine.control.probe.empty())
    reading.error(machine.where("control.probe_latch"), finding::kProbeLatchAlone,
                  {std::string(choices_of<ProbeLatch>()[latch])});
  check_buses(machine, reading);
  for (std::size_t i = 0; i < machine.stations.size(); ++i) StationCheck(machine, i, reading).all();
  check_simulation(machine, reading);
}

}  // namespace servogate::machine
