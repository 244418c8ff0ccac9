// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/capture/machine_channels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plc/logic/force_plan.hpp"

namespace servogate::gateway {

namespace {

using image::AxisImage;
using image::ProcessStatus;
using image::SpindleImage;

/// A value of a part of the machine. `unit`: "mm" becomes degrees on a rotary axis; "" is a number.
template <typename Part>
struct Field {
  std::string_view name;
  std::string_view unit;
  double (*value)(const Part&);
};

constexpr double on(bool is) { return is ? 1.0 : 0.0; }

constexpr std::array kAxisFields = std::to_array<Field<AxisImage>>({
    {"cmd", "mm", [](const AxisImage& a) { return a.command; }},
    {"act", "mm", [](const AxisImage& a) { return a.actual; }},
    {"error", "mm", [](const AxisImage& a) { return a.following_error; }},
    {"velocity", "mm/s", [](const AxisImage& a) { return a.command_velocity; }},
    {"acceleration", "mm/s2", [](const AxisImage& a) { return a.command_acceleration; }},
    {"to_go", "mm", [](const AxisImage& a) { return a.distance_to_go; }},
    {"owner", "", [](const AxisImage& a) { return static_cast<double>(a.owner); }},
    {"moving", "", [](const AxisImage& a) { return on(a.moving); }},
    {"gear", "", [](const AxisImage& a) { return static_cast<double>(a.gear.state); }},
    {"phase_error", "mm",
     [](const AxisImage& a) {
       const bool follows =
           a.gear.state == image::GearState::engaging || a.gear.state == image::GearState::in_step;
       return follows ? a.gear.phase_error : std::numeric_limits<double>::quiet_NaN();
     }},
    {"drive.target", "counts", [](const AxisImage& a) { return static_cast<double>(a.drive_command.position_counts); }},
    {"drive.position", "counts", [](const AxisImage& a) { return static_cast<double>(a.drive.position_counts); }},
    {"drive.velocity", "counts/s", [](const AxisImage& a) { return a.drive.velocity_counts_s; }},
    {"drive.torque", "permille",
     [](const AxisImage& a) {
       return a.drive.torque_known ? a.drive.torque_permille : std::numeric_limits<double>::quiet_NaN();
     }},
    {"drive.statusword", "", [](const AxisImage& a) { return static_cast<double>(a.drive.statusword); }},
    {"drive.state", "", [](const AxisImage& a) { return static_cast<double>(a.drive.state); }},
    {"drive.error_code", "", [](const AxisImage& a) { return static_cast<double>(a.drive.error_code); }},
    {"drive.missed", "cycles", [](const AxisImage& a) { return static_cast<double>(a.drive.missed); }},
});
constexpr std::array kSpindleFields = std::to_array<Field<SpindleImage>>({
    {"cmd", "rpm", [](const SpindleImage& s) { return s.command_rpm; }},
    {"act", "rpm", [](const SpindleImage& s) { return s.actual_rpm; }},
    {"angle", "deg", [](const SpindleImage& s) { return s.angle_deg; }},
    {"axis", "", [](const SpindleImage& s) { return on(s.is_axis); }},
    {"phase_error", "deg",
     [](const SpindleImage& s) {
       return s.coupled ? s.phase_error_deg : std::numeric_limits<double>::quiet_NaN();
     }},
});
constexpr std::array kProcessFields = std::to_array<Field<ProcessStatus>>({
    {"feed", "mm/s", [](const ProcessStatus& p) { return p.feed_mm_s; }},
    {"line", "", [](const ProcessStatus& p) { return static_cast<double>(p.line); }},
    {"tool", "", [](const ProcessStatus& p) { return static_cast<double>(p.tool); }},
    {"override", "", [](const ProcessStatus& p) { return p.override_ratio; }},
    {"state", "", [](const ProcessStatus& p) { return static_cast<double>(p.state); }},
    {"mode", "", [](const ProcessStatus& p) { return static_cast<double>(p.mode); }},
    {"wait", "", [](const ProcessStatus& p) { return static_cast<double>(p.wait.reason); }},
    {"wheel", "%",
     [](const ProcessStatus& p) {
       return p.wheel.chosen ? 100.0 * p.wheel.rate() : std::numeric_limits<double>::quiet_NaN();
     }},
    {"starved", "", [](const ProcessStatus& p) { return static_cast<double>(p.starved); }},
});

std::string spindle_name(std::size_t n) { return n == 0 ? "spindle" : "spindle" + std::to_string(n + 1); }
/// As the columns of a trace have them: `feed`, `feed2`.
std::string process_name(std::string_view field, std::size_t n) {
  return std::string(field) + (n == 0 ? "" : std::to_string(n + 1));
}

/// A unit of mm on a rotary axis.
std::string unit_of(std::string_view unit, const machine::AxisConfig& axis) {
  return unit.starts_with("mm") ? axis.unit() + std::string(unit.substr(2)) : std::string(unit);
}

bool is_number(image::Place place) { return place.format != image::Format::ch; }

}  // namespace

void MachineChannels::put(const Source& source, report::CaptureChannel channel) {
  for (const report::CaptureChannel& c : channels_)
    if (c.name == channel.name) return;
  channels_.push_back(std::move(channel));
  sources_.push_back(source);
}

void MachineChannels::put_axis(const Control& control, std::size_t axis, std::size_t field) {
  const machine::AxisConfig& config = control.machine().axes[axis];
  const std::string name(kAxisFields[field].name);
  put({Source::Kind::axis, static_cast<std::uint8_t>(axis), static_cast<std::uint8_t>(field)},
      {config.letter + '.' + name, unit_of(kAxisFields[field].unit, config), "/axis/" + config.letter, name});
}

void MachineChannels::put_spindle(std::size_t spindle, std::size_t field) {
  const std::string name = spindle_name(spindle), value(kSpindleFields[field].name);
  put({Source::Kind::spindle, static_cast<std::uint8_t>(spindle), static_cast<std::uint8_t>(field)},
      {name + '.' + value, std::string(kSpindleFields[field].unit), '/' + name, value});
}

void MachineChannels::put_process(std::size_t process, std::size_t field) {
  const std::string value(kProcessFields[field].name);
  put({Source::Kind::process, static_cast<std::uint8_t>(process), static_cast<std::uint8_t>(field)},
      {process_name(value, process), std::string(kProcessFields[field].unit),
       "/process/" + std::to_string(process + 1), value});
}

bool MachineChannels::add_value(Control& control, const std::string& name) {
  const machine::MachineConfig& m = control.machine();
  if (name == "alarms") {
    put({}, {name, "", "/alarms", "standing"});
    return true;
  }
  for (std::size_t a = 0; a < m.axes.size(); ++a)
    for (std::size_t f = 0; f < kAxisFields.size(); ++f)
      if (name == m.axes[a].letter + '.' + std::string(kAxisFields[f].name)) {
        put_axis(control, a, f);
        return true;
      }
  for (std::size_t s = 0; s < m.spindles.size(); ++s)
    for (std::size_t f = 0; f < kSpindleFields.size(); ++f)
      if (name == spindle_name(s) + '.' + std::string(kSpindleFields[f].name)) {
        put_spindle(s, f);
        return true;
      }
  for (int p = 0; p < m.control.processes; ++p)
    for (std::size_t f = 0; f < kProcessFields.size(); ++f)
      if (name == process_name(kProcessFields[f].name, static_cast<std::size_t>(p))) {
        put_process(static_cast<std::size_t>(p), f);
        return true;
      }
  return false;
}

bool MachineChannels::add_named(Control& control, const std::string& name) {
  if (program_ == nullptr && control.logic() != nullptr) program_ = control.logic()->program();
  const plc::Engine* engine = program_ != nullptr ? &program_->engine : nullptr;
  Source source;
  if (const auto place = plc::place_of(control.symbols(), engine, name); place && is_number(*place)) {
    source.kind = Source::Kind::place;
    source.place = *place;
    put(source, {name, "", "/places", name});
    return true;
  }
  const auto handle = engine != nullptr ? engine->find(name) : std::nullopt;
  if (!handle || std::isnan(engine->number(*handle))) return false;
  source.kind = Source::Kind::variable;
  source.handle = *handle;
  put(source, {name, "", "/plc", name});
  return true;
}

void MachineChannels::add_group(Control& control, const std::string& group) {
  const machine::MachineConfig& m = control.machine();
  const bool all = group == "all";
  if (all) add_value(control, "alarms");
  if (all || group == "processes")
    for (int p = 0; p < m.control.processes; ++p)
      for (std::size_t f = 0; f < kProcessFields.size(); ++f) put_process(static_cast<std::size_t>(p), f);
  if (all || group == "axes")
    for (std::size_t a = 0; a < m.axes.size(); ++a)
      for (std::size_t f = 0; f < kAxisFields.size(); ++f) put_axis(control, a, f);
  if (all || group == "spindles")
    for (std::size_t s = 0; s < m.spindles.size(); ++s)
      for (std::size_t f = 0; f < kSpindleFields.size(); ++f) put_spindle(s, f);
  if (all || group == "points")
    for (const machine::StationConfig& station : m.stations)
      for (const machine::PointConfig& point : station.points) add_named(control, point.name);
  if (all || group == "interface")
    for (const image::Symbol& symbol : control.symbols()) add_named(control, symbol.name);
  if ((all || group == "plc") && control.logic() != nullptr)
    for (const std::string& name : plc::variable_names(control.logic()->program()->engine.image()))
      add_named(control, name);
}

bool MachineChannels::is_group(std::string_view name) {
  constexpr std::string_view kNames[] = {"axes",      "spindles", "processes", "points",
                                         "interface", "plc",      "all"};
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

bool MachineChannels::add(Control& control, const std::string& name) {
  if (!is_group(name)) return add_value(control, name) || add_named(control, name);
  add_group(control, name);
  return true;
}

void MachineChannels::read(Control& control, std::span<double> values) const noexcept {
  const image::ProcessImage& image = control.cycle().image();
  for (std::size_t n = 0; n < sources_.size(); ++n) {
    const Source& s = sources_[n];
    switch (s.kind) {
      case Source::Kind::alarms:
        values[n] = image.alarms_active;
        break;
      case Source::Kind::axis:
        values[n] = kAxisFields[s.field].value(image.axes[s.index]);
        break;
      case Source::Kind::spindle:
        values[n] = kSpindleFields[s.field].value(image.spindles[s.index]);
        break;
      case Source::Kind::process:
        values[n] = kProcessFields[s.field].value(image.processes[s.index]);
        break;
      case Source::Kind::place:
        values[n] = s.place.format == image::Format::bl ? on(image.packets.bit(s.place))
                                                        : image.packets.number(s.place);
        break;
      case Source::Kind::variable:
        values[n] = control.logic()->number(*program_, s.handle);
        break;
    }
  }
}

}  // namespace servogate::gateway
