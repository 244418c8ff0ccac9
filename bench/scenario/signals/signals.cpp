// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/signals/signals.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "plc/variables/places.hpp"

namespace servogate::scenario {

namespace {

using image::AxisImage;
using image::ProcessStatus;
using image::SpindleImage;

constexpr std::string_view kSwitch[] = {"off", "on"};
constexpr std::string_view kStates[] = {"idle",  "running", "held", "waiting", "stopped_by_alarm",
                                        "ended", "stopped"};
constexpr std::string_view kModes[] = {"off",    "mdi",       "automatic", "step",
                                       "manual", "increment", "profile",   "home"};
constexpr std::string_view kOwners[] = {"none", "process", "manual", "homing", "plc", "bench", "gear"};
constexpr std::string_view kJogEnds[] = {"none", "arrived", "asked", "silent",
                                         "feed", "travel",  "alarm", "power"};
constexpr std::string_view kDrives[] = {
    "offline",     "not_ready_to_switch_on", "switch_on_disabled", "ready_to_switch_on",
    "switched_on", "operation_enabled",      "quick_stop_active",  "fault_reaction_active",
    "fault"};
constexpr std::string_view kWaits[] = {"none",          "signal",         "m_acknowledge", "s_acknowledge",
                                       "t_acknowledge", "h_acknowledge",  "dwell",         "in_position",
                                       "program_stop",  "optional_stop",  "block_end",     "read_in_enable",
                                       "operator_hold", "plc_hold",       "feed_enable",   "axis_feed_enable",
                                       "override_zero", "spindle_stands", "path_wheel"};
static_assert(std::size(kWaits) == image::kWaitReasons && std::size(kJogEnds) == image::kJogEnds);

constexpr std::string_view kGears[] = {"none", "engaging", "in_step", "disengaging", "refused"};
static_assert(std::size(kGears) == image::kGearStates);
constexpr std::string_view kQualities[] = {"never", "good", "stale", "bad"};

double on(bool b) { return b ? 1.0 : 0.0; }

struct AxisRow {
  std::string_view name, alias;
  std::string_view linear, rotary;  ///< unit
  std::span<const std::string_view> words;
  double (*read)(const AxisImage&);
};
constexpr AxisRow kAxis[] = {
    {"command", "cmd", "mm", "deg", {}, [](const AxisImage& a) { return a.command; }},
    {"actual", "act", "mm", "deg", {}, [](const AxisImage& a) { return a.actual; }},
    {"following_error", "error", "mm", "deg", {}, [](const AxisImage& a) { return a.following_error; }},
    {"velocity", "", "mm/s", "deg/s", {}, [](const AxisImage& a) { return a.command_velocity; }},
    {"acceleration", "", "mm/s2", "deg/s2", {}, [](const AxisImage& a) { return a.command_acceleration; }},
    {"distance_to_go", "", "mm", "deg", {}, [](const AxisImage& a) { return a.distance_to_go; }},
    {"beside", "", "mm", "deg", {}, [](const AxisImage& a) { return a.beside; }},
    {"phase_error", "", "mm", "deg", {}, [](const AxisImage& a) { return a.gear.phase_error; }},
    {"gear_state", "", "", "", kGears, [](const AxisImage& a) { return static_cast<double>(a.gear.state); }},
    {"torque", "", "%", "%", {}, [](const AxisImage& a) { return a.drive.torque_permille / 10.0; }},
    {"enabled", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.enabled); }},
    {"homed", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.homed); }},
    {"moving", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.moving); }},
    {"in_position", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.in_position); }},
    {"limit_plus", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.limit_plus); }},
    {"limit_minus", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.limit_minus); }},
    {"home_switch", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.home_switch); }},
    {"brake_released", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.brake_released); }},
    {"online", "", "", "", kSwitch, [](const AxisImage& a) { return on(a.drive.online); }},
    {"missed", "", "", "", {}, [](const AxisImage& a) { return static_cast<double>(a.drive.missed); }},
    {"owner", "", "", "", kOwners, [](const AxisImage& a) { return static_cast<double>(a.owner); }},
    {"jog_end", "", "", "", kJogEnds, [](const AxisImage& a) { return static_cast<double>(a.jog_end); }},
    {"drive", "", "", "", kDrives, [](const AxisImage& a) { return static_cast<double>(a.drive.state); }},
};

constexpr struct {
  std::string_view name, alias, unit;
  bool digital;
  double (*read)(const SpindleImage&);
} kSpindle[] = {
    {"command", "cmd", "rpm", false, [](const SpindleImage& s) { return s.command_rpm; }},
    {"actual", "act", "rpm", false, [](const SpindleImage& s) { return s.actual_rpm; }},
    {"running", "", "", true, [](const SpindleImage& s) { return on(s.running); }},
    {"at_speed", "", "", true, [](const SpindleImage& s) { return on(s.at_speed); }},
    {"is_axis", "", "", true, [](const SpindleImage& s) { return on(s.is_axis); }},
    {"coupled", "", "", true, [](const SpindleImage& s) { return on(s.coupled); }},
    {"phase_error", "", "deg", false, [](const SpindleImage& s) { return s.phase_error_deg; }},
};

constexpr struct {
  std::string_view name, unit;
  std::span<const std::string_view> words;
  double (*read)(const ProcessStatus&);
} kProcess[] = {
    {"line", "", {}, [](const ProcessStatus& p) { return static_cast<double>(p.line); }},
    {"blocks", "", {}, [](const ProcessStatus& p) { return static_cast<double>(p.blocks_done); }},
    {"tool", "", {}, [](const ProcessStatus& p) { return static_cast<double>(p.tool); }},
    {"feed", "mm/s", {}, [](const ProcessStatus& p) { return p.feed_mm_s; }},
    {"override", "%", {}, [](const ProcessStatus& p) { return p.override_ratio * 100.0; }},
    {"starved", "", {}, [](const ProcessStatus& p) { return static_cast<double>(p.starved); }},
    {"state", "", kStates, [](const ProcessStatus& p) { return static_cast<double>(p.state); }},
    {"mode", "", kModes, [](const ProcessStatus& p) { return static_cast<double>(p.mode); }},
    {"retraced_by", "mm", {}, [](const ProcessStatus& p) { return p.retraced_mm; }},
    {"wheel", "", kSwitch, [](const ProcessStatus& p) { return on(p.wheel.chosen); }},
    {"wheel_lost", "", kSwitch, [](const ProcessStatus& p) { return on(p.wheel.lost); }},
    {"wheel_rate", "%", {}, [](const ProcessStatus& p) { return p.wheel.rate() * 100.0; }},
    {"waits_for", "", kWaits, [](const ProcessStatus& p) { return static_cast<double>(p.wait.reason); }},
};

constexpr QuantityRow kQuantities[] = {
    {"X.command", "mm, deg", "set-point (a radius on diameter axes); also X.cmd",
     "уставка (на осях с диаметром радиус); также X.cmd"},
    {"X.actual", "mm, deg", "measured place; also X.act", "измеренное место; также X.act"},
    {"X.following_error", "mm, deg", "set-point minus measured place at equal times; also X.error",
     "уставка минус измеренное место в один момент; также X.error"},
    {"X.velocity, X.acceleration", "mm/s, mm/s2", "of the set-point", "уставки"},
    {"X.distance_to_go, X.beside", "mm, deg", "way left; way beside a held program",
     "остаток пути; уход от остановленной программы"},
    {"X.torque", "%", "of the rated torque", "от номинального момента"},
    {"X.enabled, X.homed, X.moving, X.in_position, X.online, X.brake_released", "", "on or off",
     "on или off"},
    {"X.limit_plus, X.limit_minus, X.home_switch", "", "on or off", "on или off"},
    {"X.missed", "", "cycles in a row without fresh process data of the drive",
     "тактов подряд без свежих данных процесса от привода"},
    {"X.owner", "", "none, process, manual, homing, plc, bench, gear",
     "none, process, manual, homing, plc, bench, gear"},
    {"X.gear_state", "", "none, engaging, in_step, disengaging, refused",
     "none, engaging, in_step, disengaging, refused"},
    {"X.phase_error", "mm, deg",
     "of an axis that is geared: how far it is behind its master, as both are measured",
     "оси с электронным редуктором: насколько она отстаёт от ведущей, по измерениям обеих"},
    {"X.jog_end", "", "none, arrived, asked, silent, feed, travel, alarm, power",
     "none, arrived, asked, silent, feed, travel, alarm, power"},
    {"X.drive", "", "state of CiA 402: operation_enabled, fault, offline ...",
     "состояние по CiA 402: operation_enabled, fault, offline ..."},
    {"S.command, S.actual", "rpm", "of the spindle; S2. of the second", "шпинделя; S2. второго"},
    {"S.running, S.at_speed", "", "on or off", "on или off"},
    {"S.is_axis, S.coupled", "",
     "it is its rotary axis; it is held to the angle of the first spindle: on or off",
     "работает как поворотная ось; удерживается по углу первого шпинделя: on или off"},
    {"S.phase_error", "deg", "of a spindle that is coupled: how far it is behind that angle",
     "связанного шпинделя: насколько он отстаёт от этого угла"},
    {"NC.line, NC.blocks, NC.tool, NC.starved", "", "of the program of process 1; NC2. of the second ...",
     "программы процесса 1; NC2. второго ..."},
    {"NC.feed", "mm/s", "speed along the path", "скорость по контуру"},
    {"NC.override", "%", "feed override", "коррекция подачи"},
    {"NC.retraced_by", "mm", "path from where a held program was driven back to, to where it was held",
     "путь от места, куда приостановленная программа отведена назад, до места останова"},
    {"NC.wheel, NC.wheel_lost", "", "it follows its handwheel along the path; that is lost: on or off",
     "следует маховичку по контуру; он потерян: on или off"},
    {"NC.wheel_rate", "%", "speed of that handwheel, of the programmed feed; below 0: back",
     "скорость этого маховичка, от запрограммированной подачи; меньше 0 — назад"},
    {"NC.state", "", "idle, running, held, waiting, stopped_by_alarm, ended, stopped",
     "idle, running, held, waiting, stopped_by_alarm, ended, stopped"},
    {"NC.mode", "", "off, mdi, automatic, step, manual, increment, profile, home",
     "off, mdi, automatic, step, manual, increment, profile, home"},
    {"NC.waits_for", "",
     "none, signal, m_acknowledge, feed_enable, program_stop ... (docs/control-socket.md)",
     "none, signal, m_acknowledge, feed_enable, program_stop ... (docs/control-socket.md)"},
    {"alarms", "", "number of alarms that are not acknowledged", "число неподтверждённых аварий"},
    {"panel.quality", "", "of a station, chip or line's device: never, good, stale, bad",
     "станции, чипа или устройства линии: never, good, stale, bad"},
    {"can.errors, can.load", "%",
     "errors that the controller of a bus has counted; its load over the last second in %",
     "ошибки, подсчитанные контроллером шины; её загрузка за последнюю секунду в %"},
    {"can.x.online", "", "a node of a bus: on or off", "узел шины: on или off"},
};

/// The number behind `word` in a name as NC2 or S2, from 0; -1: another name.
int numbered(std::string_view name, std::string_view word) {
  if (!name.starts_with(word)) return -1;
  const std::string_view digits = name.substr(word.size());
  if (digits.empty()) return 0;
  int n = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
  return error == std::errc{} && end == digits.data() + digits.size() && n >= 1 ? n - 1 : -1;
}

machine::Unit unit_of(std::string_view unit) {
  using machine::Unit;
  if (unit == "mm" || unit == "deg") return Unit::axis_length;
  if (unit == "mm/s" || unit == "deg/s") return Unit::axis_velocity;
  if (unit == "mm/s2" || unit == "deg/s2") return Unit::axis_acceleration;
  if (unit == "rpm") return Unit::rpm;
  return unit == "%" ? Unit::percent : Unit::none;
}

std::optional<double> plain_number(std::string_view text) {
  double value = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<double> quantity(const Value& value, std::string_view unit) {
  if (const auto* number = std::get_if<double>(&value.is)) return *number;
  const auto* const text = std::get_if<std::string>(&value.is);
  if (text == nullptr) return std::nullopt;
  if (unit_of(unit) == machine::Unit::none) return plain_number(*text);
  const auto read = machine::parse_quantity(
      *text, unit_of(unit),
      unit.starts_with("deg") ? machine::AxisUnits::rotary : machine::AxisUnits::linear);
  return read.error == machine::QuantityError::none ? std::optional(read.value) : std::nullopt;
}

}  // namespace

std::span<const QuantityRow> quantities() noexcept { return kQuantities; }

std::optional<double> Signals::number(const Value& value, const Signal& signal) {
  if (const auto* flag = std::get_if<bool>(&value.is))
    return signal.digital ? std::optional(on(*flag)) : std::nullopt;
  if (const auto* text = std::get_if<std::string>(&value.is); text != nullptr && !signal.words.empty()) {
    const auto word = std::find(signal.words.begin(), signal.words.end(), *text);
    return word == signal.words.end() ? std::nullopt
                                      : std::optional(static_cast<double>(word - signal.words.begin()));
  }
  return quantity(value, signal.unit);
}

std::optional<double> Signals::length(const Value& value, int axis) const {
  return quantity(value, axis < 0 ? "mm" : machine_.axes[static_cast<std::size_t>(axis)].unit());
}

std::vector<int> Signals::axes(const std::vector<std::string>& letters) const {
  std::vector<int> out;
  for (const std::string& letter : letters) {
    if (letter != "all") {
      out.push_back(machine_.axis_index(letter));
      continue;
    }
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) out.push_back(static_cast<int>(a));
  }
  return out;
}

std::optional<Signal> Signals::of_axis(std::string_view letter, std::string_view what) const {
  const int index = machine_.axis_index(std::string(letter));
  if (index < 0) return std::nullopt;
  const auto row = std::find_if(std::begin(kAxis), std::end(kAxis), [&](const AxisRow& r) {
    return r.name == what || (!r.alias.empty() && r.alias == what);
  });
  if (row == std::end(kAxis)) return std::nullopt;
  const auto i = static_cast<std::size_t>(index);
  Signal s;
  s.unit = std::string_view(machine_.axes[i].unit()) == "deg" ? row->rotary : row->linear;
  s.words = row->words;
  s.digital = row->words.data() == std::data(kSwitch);
  s.read = [i, read = row->read](const View& view) { return read(view.image.axes[i]); };
  return s;
}

std::optional<Signal> Signals::of_spindle(int index, std::string_view what) const {
  if (index < 0 || index >= static_cast<int>(machine_.spindles.size())) return std::nullopt;
  for (const auto& row : kSpindle) {
    if (row.name != what && (row.alias.empty() || row.alias != what)) continue;
    Signal s;
    s.unit = row.unit;
    s.digital = row.digital;
    if (row.digital) s.words = kSwitch;
    s.read = [index, read = row.read](const View& view) {
      return read(view.image.spindles[static_cast<std::size_t>(index)]);
    };
    return s;
  }
  return std::nullopt;
}

std::optional<Signal> Signals::of_process(int index, std::string_view what) const {
  if (index < 0 || index >= machine_.control.processes) return std::nullopt;
  for (const auto& row : kProcess) {
    if (row.name != what) continue;
    Signal s;
    s.unit = row.unit;
    s.words = row.words;
    s.read = [index, read = row.read](const View& view) {
      return read(view.image.processes[static_cast<std::size_t>(index)]);
    };
    return s;
  }
  return std::nullopt;
}

std::optional<Signal> Signals::of_place(std::string_view name) const {
  const auto place = plc::place_of(symbols_, name);
  if (!place || place->format == image::Format::ch) return std::nullopt;
  Signal s;
  if (place->format == image::Format::bl) {
    s.digital = true;
    s.words = kSwitch;
    s.read = [p = *place](const View& view) { return on(view.image.packets.bit(p)); };
  } else {
    s.read = [p = *place](const View& view) { return view.image.packets.number(p); };
  }
  return s;
}

std::optional<Signal> Signals::find(std::string_view name) const {
  const std::size_t dot = name.rfind('.');
  std::optional<Signal> found;
  if (name == "alarms") {
    found = Signal{.read = [](const View& view) { return static_cast<double>(view.image.alarms_active); }};
  } else if (name == "feed" || name == "line" || name == "tool") {
    found = of_process(0, name);
  } else if (dot != std::string_view::npos) {
    const std::string_view owner = name.substr(0, dot), what = name.substr(dot + 1);
    found = of_axis(owner, what);
    if (!found) found = of_process(numbered(owner, "NC"), what);
    if (!found) found = of_spindle(owner == "spindle" ? 0 : numbered(owner, "S"), what);
    for (std::size_t n = 0; !found && what == "quality" && n < machine_.stations.size(); ++n)
      if (machine_.stations[n].name == owner && n < image::kMaxSources)
        found = Signal{.words = kQualities, .read = [n](const View& view) {
                         return static_cast<double>(view.image.sources[n].quality);
                       }};
    for (std::size_t b = 0; !found && b < machine_.buses.size(); ++b) {
      if (machine_.buses[b].name != owner) continue;
      if (what == "errors")
        found = Signal{
            .read = [b](const View& view) { return static_cast<double>(view.image.segments[b].errors); }};
      if (what == "load")
        found = Signal{.unit = "%",
                       .read = [b](const View& view) { return view.image.segments[b].load * 100.0; }};
    }
    for (std::size_t b = 0; !found && what == "online" && b < machine_.buses.size(); ++b)
      for (const machine::NodeConfig& node : machine_.buses[b].nodes)
        if (machine_.buses[b].name + "." + node.name == owner)
          found = Signal{.words = kSwitch, .digital = true, .read = [b, id = node.id](const View& view) {
                           return on(view.image.segments[b].nodes[static_cast<std::size_t>(id)].online);
                         }};
  }
  if (!found) found = of_place(name);
  if (!found && variables_ != nullptr)
    if (const auto variable = variables_->watch(name))
      found = Signal{.read = [this, v = *variable](const View&) { return variables_->value(v); }};
  if (found) found->name = name;
  return found;
}

std::string words_of(double value, const Signal& signal) {
  if (!signal.words.empty()) {
    const auto n = static_cast<std::size_t>(value);
    return value >= 0.0 && n < signal.words.size() ? std::string(signal.words[n]) : text::number(value, 0);
  }
  return text::number(value, 4) + (signal.unit.empty() ? "" : " ") + std::string(signal.unit);
}

}  // namespace servogate::scenario
