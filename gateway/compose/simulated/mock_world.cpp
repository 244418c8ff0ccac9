// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/simulated/mock_world.hpp"

#include <algorithm>
#include <cmath>

#include "gateway/compose/points/point_rules.hpp"
#include "gateway/compose/setup/modbus_setup.hpp"
#include "gateway/compose/simulated/simulated_node.hpp"

namespace servogate::gateway {

namespace {

/// A station as its device file says, everything off.
mock::StationSettings station_settings(const machine::StationConfig& station,
                                       const machine::ModbusMap& layout) {
  mock::StationSettings s;
  s.unit = static_cast<std::uint8_t>(station.unit);
  s.digital_inputs = static_cast<std::uint16_t>(layout.di_count);
  s.digital_outputs = static_cast<std::uint16_t>(layout.dq_count);
  s.analog_inputs = static_cast<std::uint16_t>(layout.ai_count);
  s.analog_outputs = static_cast<std::uint16_t>(layout.aq_count);
  s.digital_inputs_at = static_cast<std::uint16_t>(layout.di_address);
  s.digital_outputs_at = static_cast<std::uint16_t>(layout.dq_address);
  s.analog_inputs_at = static_cast<std::uint16_t>(layout.ai_address);
  s.analog_outputs_at = static_cast<std::uint16_t>(layout.aq_address);
  s.inputs_in_registers = layout.di_as_registers;
  s.initial_inputs.resize(s.digital_inputs);
  s.initial_analog.resize(s.analog_inputs);
  s.watchdog_ns = 20 * static_cast<image::Nanoseconds>(station.period * 1e9);
  s.coil_loss.resize(s.digital_outputs);
  s.holding_loss.resize(s.analog_outputs);
  for (const machine::PointConfig& p : station.points) {
    if (p.is_input()) continue;
    auto& outputs = p.is_analog() ? s.holding_loss : s.coil_loss;
    const double wire = std::clamp(p.loss, -32768.0, 65535.0);
    if (const auto n = static_cast<std::size_t>(p.number); n < outputs.size())
      outputs[n] = {p.hold, static_cast<std::uint16_t>(std::lround(wire))};
  }
  return s;
}

}  // namespace

MockWorld::MockWorld(const machine::LoadResult& loaded) {
  const machine::MachineConfig& m = loaded.machine;
  axes_.resize(m.axes.size());
  add_drives(loaded);
  int source = 0;
  for (const machine::StationConfig& station : m.stations) {
    if (station.over_bus()) add_node_wires(loaded, station);
    if (station.mock() && station.kind == machine::StationKind::gpio) add_gpio(loaded, station, source);
    // A line stands where its first station does.
    if (const machine::LineConfig* line = m.line(station.line);
        line != nullptr && station.mock() && station.kind == machine::StationKind::modbus &&
        stations_of_line(loaded, line->name).front().station == &station)
      add_line(loaded, *line);
    ++source;
  }
  add_turrets(m);
  add_wires(m);
  operator_points_ = m.simulation.operator_closes;
}

MockWorld::~MockWorld() = default;

void MockWorld::add_drives(const machine::LoadResult& loaded) {
  const machine::MachineConfig& m = loaded.machine;
  for (const machine::BusConfig& bus : m.buses) {
    if (!bus.mock()) {
      segments_.push_back(nullptr);
      endpoints_.push_back(nullptr);
      continue;
    }
    mock::CanSegmentConfig config;
    config.bit_rate = static_cast<std::uint32_t>(bus.bit_rate);
    segments_.push_back(std::make_unique<mock::CanSegment>(config));
    endpoints_.push_back(&segments_.back()->add_endpoint("control"));
    for (const machine::NodeConfig& node : bus.nodes) add_node(loaded, bus, node);
  }
  for (std::size_t a = 0; a < m.axes.size(); ++a) {
    AxisDrive& axis = axes_[a];
    axis.drive = drive(m.axes[a].drive);
    axis.units_per_revolution = units_per_revolution(m.axes[a]);
    axis.counts_per_revolution = static_cast<double>(std::max<std::int64_t>(1, m.axes[a].counts_per_rev));
    for (const machine::SimulatedDrive& s : m.simulation.drives)
      if (s.node == m.axes[a].drive && !s.absolute_encoder) axis.start = s.start;
  }
}

/// The device of a node, on the wire that was made last.
void MockWorld::add_node(const machine::LoadResult& loaded, const machine::BusConfig& bus,
                         const machine::NodeConfig& node) {
  const std::string reference = bus.name + "." + node.name;
  const machine::DeviceConfig* device = loaded.device(node.device);
  mock::CanNode* made = nullptr;
  if (device != nullptr && device->kind == machine::DeviceKind::canopen_io) {
    modules_.push_back(
        {reference, std::make_unique<mock::SimulatedIoModule>(simulated_module(*device, node.id))});
    made = modules_.back().device.get();
  } else if (device != nullptr && device->kind == machine::DeviceKind::canopen_encoder) {
    encoders_.push_back(
        {reference, std::make_unique<mock::SimulatedEncoder>(simulated_encoder(*device, node.id))});
    made = encoders_.back().device.get();
  } else {
    drives_.push_back({reference, std::make_unique<mock::SimulatedDrive>(simulated_node(loaded, bus, node))});
    made = drives_.back().device.get();
  }
  segments_.back()->attach(*made, node.name);
}

/// An input line of the chip that is made next: its contact follows a switch or is set.
mock::GpioInput MockWorld::contact(const machine::MachineConfig& m, const machine::PointConfig& p) {
  mock::GpioInput input;
  input.name = p.name;
  input.rule = point_rule(p);
  const auto initial = m.simulation.initial.find(p.name);
  input.source = mock::SetInput{initial != m.simulation.initial.end() && initial->second != 0.0};
  for (const machine::SimulatedSwitch& s : m.simulation.switches) {
    if (s.point != p.name) continue;
    const int axis = m.axis_index(s.axis);
    if (std::isinf(s.to))
      input.source = mock::LimitSwitch{axis, s.from, true};
    else if (std::isinf(s.from))
      input.source = mock::LimitSwitch{axis, s.to, false};
    else
      input.source = mock::HomeSwitch{axis, s.from, s.to - s.from};
  }
  return input;
}

void MockWorld::add_gpio(const machine::LoadResult& loaded, const machine::StationConfig& station,
                         int source) {
  std::vector<mock::GpioInput> inputs;
  std::vector<mock::GpioOutput> outputs;
  for (const machine::PointConfig& p : station.points) {
    if (!p.is_input()) {
      outputs_.push_back({p.name, gpios_.size(), outputs.size(), true, p.inverted});
      outputs.push_back({p.name, point_rule(p)});
      continue;
    }
    mock::GpioInput input = contact(loaded.machine, p);
    const bool switched = !std::holds_alternative<mock::SetInput>(input.source);
    inputs_.push_back({p.name, gpios_.size(), inputs.size(), true, p.inverted, false, switched});
    inputs.push_back(std::move(input));
  }
  gpios_.push_back(std::make_unique<mock::MockGpio>(
      std::move(inputs), std::move(outputs), [this](int axis) { return axis_position(axis); }, source));
  chips_[station.name] = gpios_.back().get();
  io_.push_back(gpios_.back().get());
}

/// Contacts that lead to a drive or an I/O module: their levels reach packet A over the bus, so the lines are
/// no device of the cycle.
void MockWorld::add_node_wires(const machine::LoadResult& loaded, const machine::StationConfig& station) {
  NodeWires wires{gpios_.size(), drive(station.node), module(station.node), {}};
  for (const machine::PointConfig& p : station.points)
    if (p.channel == machine::ChannelKind::ai && p.number >= 0) add_analog(loaded.machine, station, p);
  if (wires.drive == nullptr && wires.module == nullptr) return;
  std::vector<mock::GpioInput> inputs;
  for (const machine::PointConfig& p : station.points) {
    if (p.number < 0 || p.is_analog()) continue;
    if (!p.is_input()) {
      outputs_.push_back(
          {p.name, 0, static_cast<std::size_t>(p.number), false, p.inverted, wires.drive, wires.module});
      continue;
    }
    mock::GpioInput input = contact(loaded.machine, p);
    const bool switched = !std::holds_alternative<mock::SetInput>(input.source);
    inputs_.push_back({p.name, gpios_.size(), inputs.size(), true, p.inverted, false, switched});
    inputs.push_back(std::move(input));
    wires.bits.push_back(p.number);
  }
  gpios_.push_back(std::make_unique<mock::MockGpio>(std::move(inputs), std::vector<mock::GpioOutput>{},
                                                    [this](int axis) { return axis_position(axis); }));
  node_wires_.push_back(std::move(wires));
}

void MockWorld::add_analog(const machine::MachineConfig& m, const machine::StationConfig& station,
                           const machine::PointConfig& p) {
  Input input{p.name, 0, static_cast<std::size_t>(p.number), false, false, true, false, p.scale, p.shift};
  input.module = module(station.node);
  input.encoder = p.number == 0 ? encoder(station.node) : nullptr;
  if (input.module == nullptr && input.encoder == nullptr) return;
  inputs_.push_back(input);
  if (const auto initial = m.simulation.initial.find(p.name); initial != m.simulation.initial.end())
    play_raw(input, initial->second);
}

void MockWorld::carry_wires(const NodeWires& wires) {
  using Terminal = mock::DriveSwitch::Input;
  std::uint16_t general = 0;
  for (std::size_t n = 0; n < wires.bits.size(); ++n) {
    const bool on = gpios_[wires.wires]->input(n);
    const int bit = wires.bits[n];
    if (wires.module != nullptr) {
      wires.module->set_digital(static_cast<std::uint8_t>(bit), on);
      continue;
    }
    if (bit == 0) wires.drive->set_input(Terminal::negative_limit, on);
    if (bit == 1) wires.drive->set_input(Terminal::positive_limit, on);
    if (bit == 2) wires.drive->set_input(Terminal::home, on);
    if (bit == 3) wires.drive->set_interlock(on);
    if (bit >= 16 && on) general = static_cast<std::uint16_t>(general | 1u << (bit - 16));
  }
  if (wires.drive != nullptr) wires.drive->set_general_inputs(general);
}

/// The unit of that number on the line that is made next.
mock::StationSettings MockWorld::add_unit(const machine::MachineConfig& m, const LineStation& unit,
                                          std::size_t n) {
  mock::StationSettings settings = station_settings(*unit.station, unit.layout);
  for (const machine::PointConfig& p : unit.station->points) {
    const auto initial = m.simulation.initial.find(p.name);
    const double value = initial != m.simulation.initial.end() ? initial->second : 0.0;
    const auto number = static_cast<std::size_t>(p.number);
    if (p.channel == machine::ChannelKind::di && number < settings.initial_inputs.size()) {
      settings.initial_inputs[number] = value != 0.0;
      inputs_.push_back({p.name, lines_.size(), number, false, p.inverted});
      inputs_.back().unit = n;
    } else if (p.channel == machine::ChannelKind::ai && number < settings.initial_analog.size()) {
      settings.initial_analog[number] = static_cast<std::uint16_t>(value);
      inputs_.push_back({p.name, lines_.size(), number, false, false, true, false, p.scale, p.shift});
      inputs_.back().unit = n;
    } else if (p.channel == machine::ChannelKind::dq) {
      outputs_.push_back({p.name, lines_.size(), number, false, p.inverted});
      outputs_.back().unit = n;
    }
  }
  return settings;
}

void MockWorld::add_line(const machine::LoadResult& loaded, const machine::LineConfig& config) {
  const machine::MachineConfig& m = loaded.machine;
  const std::vector<LineStation> units = stations_of_line(loaded, config.name);
  std::vector<mock::StationSettings> settings;
  std::vector<int> sources;
  for (const LineStation& unit : units) {
    settings.push_back(add_unit(m, unit, settings.size()));
    sources.push_back(unit.source);
  }
  mock::LineSettings line;
  line.baud = static_cast<std::uint32_t>(config.baud);
  line.answer_timeout_ns = static_cast<image::Nanoseconds>(std::llround(config.timeout * 1e9));
  lines_.push_back(
      std::make_unique<mock::MockModbusLine>(line, line_map(units), std::move(settings), sources));
  for (const machine::SimulatedLoop& loop : m.simulation.loops) {
    int from = -1, to = -1;
    const machine::PointConfig* out = m.point(loop.output, &from);
    const machine::PointConfig* in = m.point(loop.input, &to);
    for (std::size_t n = 0; n < units.size(); ++n)
      if (out != nullptr && in != nullptr && from == units[n].source && to == units[n].source)
        lines_.back()->station(n).add_loopback(
            {static_cast<std::uint16_t>(out->number), static_cast<std::uint16_t>(in->number),
             static_cast<image::Nanoseconds>(std::llround(loop.delay * 1e9)), loop.inverted});
  }
  for (std::size_t n = 0; n < units.size(); ++n) units_[units[n].station->name] = &lines_.back()->station(n);
  io_.push_back(lines_.back().get());
}

void MockWorld::add_turrets(const machine::MachineConfig& machine) {
  for (const machine::SimulatedIndexer& config : machine.simulation.indexers) {
    std::vector<std::size_t> inputs;
    int start = 0;
    for (const std::string& name : config.inputs)
      for (std::size_t i = 0; i < inputs_.size(); ++i) {
        if (inputs_[i].name != name) continue;
        const auto initial = machine.simulation.initial.find(name);
        if (initial != machine.simulation.initial.end() && initial->second != 0.0)
          start = static_cast<int>(inputs.size());
        inputs.push_back(i);
        inputs_[i].looped = true;
      }
    for (std::size_t o = 0; o < outputs_.size(); ++o)
      if (outputs_[o].name == config.output && inputs.size() == config.inputs.size())
        turrets_.push_back(
            {mock::Indexer(static_cast<int>(inputs.size()),
                           static_cast<image::Nanoseconds>(std::llround(config.step * 1e9)), start),
             o, inputs});
  }
}

void MockWorld::add_wires(const machine::MachineConfig& m) {
  for (const machine::SimulatedLoop& loop : m.simulation.loops) {
    for (Input& input : inputs_) input.looped = input.looped || input.name == loop.input;
    int from = -1, to = -1;
    if (m.point(loop.output, &from) == nullptr || m.point(loop.input, &to) == nullptr) continue;
    if (from == to && m.stations[static_cast<std::size_t>(to)].kind == machine::StationKind::modbus) continue;
    const auto named = [](const auto& list, const std::string& name) {
      return static_cast<std::size_t>(
          std::ranges::find_if(list, [&](const auto& item) { return item.name == name; }) - list.begin());
    };
    const std::size_t output = named(outputs_, loop.output), input = named(inputs_, loop.input);
    if (output < outputs_.size() && input < inputs_.size() && !inputs_[input].analog)
      wires_.push_back(
          {output, input, loop.inverted, static_cast<image::Nanoseconds>(std::llround(loop.delay * 1e9))});
  }
}

/// Levels of the wires themselves: `inverted` of the two points is not theirs.
void MockWorld::carry(Wire& wire, image::Nanoseconds t) {
  const Output& from = outputs_[wire.output];
  const bool level = motor_on(from) != from.inverted;
  if (wire.level != level) {
    wire.level = level;
    wire.since = t;
  }
  if (t - wire.since >= wire.delay_ns && !inputs_[wire.input].held)
    drive_input(inputs_[wire.input], (level != wire.inverted) != inputs_[wire.input].inverted);
}

void MockWorld::turn(Turret& turret, image::Nanoseconds t) {
  turret.indexer.advance_to(t, motor_on(outputs_[turret.motor]));
  const int position = turret.indexer.position();
  if (position == turret.shown) return;
  turret.shown = position;
  for (std::size_t i = 0; i < turret.inputs.size(); ++i)
    if (!inputs_[turret.inputs[i]].held)
      drive_input(inputs_[turret.inputs[i]], static_cast<int>(i) == position);
}

void MockWorld::advance_to(image::Nanoseconds t) {
  if (wished_.load(std::memory_order_acquire)) apply_wishes();
  for (Turret& turret : turrets_) turn(turret, t);
  for (Wire& wire : wires_) carry(wire, t);
  for (const auto& segment : segments_)
    if (segment != nullptr) segment->advance_to(t);
  for (const auto& gpio : gpios_) gpio->advance_to(t);
  for (const NodeWires& wires : node_wires_) carry_wires(wires);
  for (const auto& line : lines_) line->advance_to(t);
}

image::CanBus* MockWorld::bus(std::size_t index) { return endpoints_[index]; }

bool MockWorld::drive_input(const Input& i, bool on) {
  const bool contact = on != i.inverted;
  return i.gpio ? gpios_[i.device]->set_input(i.number, contact)
                : lines_[i.device]->station(i.unit).set_input(static_cast<std::uint16_t>(i.number), contact);
}

bool MockWorld::motor_on(const Output& o) const {
  if (o.module != nullptr) return o.module->digital(static_cast<std::uint8_t>(o.number)) != o.inverted;
  if (o.drive != nullptr) return ((o.drive->digital_outputs() >> o.number & 1) != 0) != o.inverted;
  const bool level = o.gpio ? gpios_[o.device]->output(o.number)
                            : lines_[o.device]->station(o.unit).output(static_cast<std::uint16_t>(o.number));
  return level != o.inverted;
}

bool MockWorld::set_input(std::string_view point, bool on) {
  for (const Input& i : inputs_)
    if (i.name == point && !i.analog) return drive_input(i, on);
  return false;
}

MockWorld::Played MockWorld::play_input(std::string_view point, Play play) {
  for (std::size_t n = 0; n < inputs_.size(); ++n) {
    if (inputs_[n].name != point) continue;
    if (!play.value && !inputs_[n].switched && !inputs_[n].looped) return Played::follows_nothing;
    const std::scoped_lock lock(wishes_lock_);
    wishes_.push_back({n, play});
    wished_.store(true, std::memory_order_release);
    return Played::done;
  }
  return Played::no_such_input;
}

void MockWorld::apply_wishes() {
  const std::scoped_lock lock(wishes_lock_);
  wished_.store(false, std::memory_order_relaxed);
  for (const Wish& wish : wishes_) {
    const Input& i = inputs_[wish.input];
    const double value = wish.play.value.value_or(0.0);
    if (i.analog) {
      play_raw(i, i.scale != 0.0 ? (value - i.shift) / i.scale : value);
    } else if (i.looped) {
      play_looped(wish.input, wish.play);
    } else if (!i.switched) {
      drive_input(i, value != 0.0);
    } else if (wish.play.value) {
      gpios_[i.device]->force_input(i.number, (value != 0.0) != i.inverted);
    } else {
      gpios_[i.device]->release_input(i.number);
    }
  }
  wishes_.clear();
}

/// What is played stays, whatever the output does; let go, the input shows at once what it should.
void MockWorld::play_looped(std::size_t input, const Play& play) {
  Input& i = inputs_[input];
  i.held = play.value.has_value();
  const bool contact = play.value.value_or(0.0) != 0.0;
  if (i.gpio) {
    if (i.held) drive_input(i, contact);
  } else if (mock::ModbusStation& station = lines_[i.device]->station(i.unit); i.held) {
    station.hold_input(static_cast<std::uint16_t>(i.number), contact != i.inverted);
  } else {
    station.let_go_input(static_cast<std::uint16_t>(i.number));
  }
  if (i.held) return;
  for (Turret& turret : turrets_)
    if (std::ranges::find(turret.inputs, input) != turret.inputs.end()) turret.shown = -2;
}

void MockWorld::play_raw(const Input& i, double raw) {
  const auto within = [raw](double low, double high) { return std::llround(std::clamp(raw, low, high)); };
  if (i.encoder != nullptr)
    i.encoder->set_position(within(-2147483648.0, 4294967295.0));
  else if (i.module != nullptr)
    i.module->set_analogue(static_cast<std::uint8_t>(i.number),
                           static_cast<std::int16_t>(within(-32768.0, 32767.0)));
  else
    lines_[i.device]->station(i.unit).set_analog_input(
        static_cast<std::uint16_t>(i.number), static_cast<std::uint16_t>(within(0.0, kLargestRegister)));
}

void MockWorld::close_operator_points() {
  for (const std::string& point : operator_points_) set_input(point, true);
}

mock::SimulatedDrive* MockWorld::drive(std::string_view reference) {
  for (Drive& d : drives_)
    if (d.reference == reference) return d.device.get();
  return nullptr;
}

mock::SimulatedIoModule* MockWorld::module(std::string_view reference) {
  for (Module& m : modules_)
    if (m.reference == reference) return m.device.get();
  return nullptr;
}

mock::SimulatedEncoder* MockWorld::encoder(std::string_view reference) {
  for (Encoder& e : encoders_)
    if (e.reference == reference) return e.device.get();
  return nullptr;
}

mock::ModbusStation* MockWorld::modbus(std::string_view station) {
  const auto found = units_.find(station);
  return found != units_.end() ? found->second : nullptr;
}

mock::MockGpio* MockWorld::chip(std::string_view station) {
  const auto found = chips_.find(station);
  return found != chips_.end() ? found->second : nullptr;
}

MockWorld::Line MockWorld::line(std::string_view point) {
  for (const Input& i : inputs_)
    if (i.name == point && i.gpio) return {gpios_[i.device].get(), i.number, i.inverted};
  return {};
}

void MockWorld::note_feedback(const image::ProcessImage& image) noexcept {
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (axes_[a].drive == nullptr && image.axes[a].drive.online)
      axes_[a].reported_counts = image.axes[a].drive.position_counts;
}

double MockWorld::axis_position(int axis) const {
  const AxisDrive& a = axes_[static_cast<std::size_t>(axis)];
  if (a.drive != nullptr) return a.drive->revolutions() * a.units_per_revolution;
  return a.start + static_cast<double>(a.reported_counts) / a.counts_per_revolution * a.units_per_revolution;
}

}  // namespace servogate::gateway
