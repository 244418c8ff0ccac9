// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/world_setup.hpp"

#include <algorithm>
#include <cmath>

#include "gateway/control/compose/points/point_rules.hpp"
#include "gateway/control/compose/setup/modbus_setup.hpp"
#include "gateway/control/compose/simulated/simulated_node.hpp"
#include "machine/loading/pendant_layout.hpp"
#include "machine/modbus_blocks.hpp"

namespace servogate::gateway {

namespace {

image::Nanoseconds nanoseconds(double seconds) {
  return static_cast<image::Nanoseconds>(std::llround(seconds * 1e9));
}

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

/// An inverter that reaches its speeds a little sooner than it is told to.
mock::SimulatedInverterSettings inverter_settings(const LineStation& s) {
  constexpr double kQuicker = 1.25, kHeadroom = 1.1;
  mock::SimulatedInverterSettings out;
  out.registers = machine::inverter_registers(s.inverter->inverter);
  out.max_hz = kHeadroom * s.spindle->largest_hertz();
  out.ramp_hz_s = kQuicker * s.spindle->hertz(s.spindle->acceleration);
  out.silence_trip = static_cast<std::uint16_t>(s.inverter->inverter.silence_fault);
  return out;
}

class Setup {
 public:
  Setup(const machine::LoadResult& loaded, mock::World& world)
      : loaded_(loaded), m_(loaded.machine), world_(world) {}

  void all() {
    for (const machine::BusConfig& bus : m_.buses) add_bus(bus);
    for (const machine::StationConfig& station : m_.stations)
      if (station.kind == machine::StationKind::board && station.mock()) add_board(station);
    for (const machine::AxisConfig& axis : m_.axes) add_axis(axis);
    for (std::size_t s = 0; s < m_.stations.size(); ++s) add_station(m_.stations[s], static_cast<int>(s));
    for (const machine::SimulatedIndexer& indexer : m_.simulation.indexers) add_indexer(indexer);
    for (const machine::SimulatedLoop& loop : m_.simulation.loops)
      world_.add_loop({loop.output, loop.input, loop.inverted, nanoseconds(loop.delay)});
    for (const std::string& point : m_.simulation.operator_closes) world_.add_operator_point(point);
    for (const machine::PendantConfig& pendant : m_.pendants)
      if (const machine::DeviceConfig* device = loaded_.device(pendant.device);
          pendant.mock() && device != nullptr)
        world_.add_pendant(pendant.name, machine::pendant_layout(*device, pendant));
  }

 private:
  /// The value at power-on, as on the wire; nullopt: none is given.
  std::optional<double> initial(const std::string& point) const {
    const auto found = m_.simulation.initial.find(point);
    return found != m_.simulation.initial.end() ? std::optional(found->second) : std::nullopt;
  }

  void add_bus(const machine::BusConfig& bus) {
    if (!bus.mock()) return world_.add_outside_bus();
    mock::CanSegmentConfig config;
    config.bit_rate = static_cast<std::uint32_t>(bus.bit_rate);
    world_.add_bus(config);
    for (const machine::NodeConfig& node : bus.nodes) {
      const std::string reference = bus.name + "." + node.name;
      const machine::DeviceConfig* device = loaded_.device(node.device);
      if (device != nullptr && device->kind == machine::DeviceKind::canopen_io)
        world_.add_module(reference, node.name, simulated_module(*device, node.id));
      else if (device != nullptr && device->kind == machine::DeviceKind::canopen_encoder)
        world_.add_encoder(reference, node.name, simulated_encoder(*device, node.id));
      else
        world_.add_drive(reference, node.name, simulated_node(loaded_, bus, node));
    }
  }

  void add_axis(const machine::AxisConfig& config) {
    mock::WorldAxis axis;
    axis.drive = config.drive;
    axis.units_per_revolution = units_per_revolution(config);
    axis.counts_per_revolution = static_cast<double>(std::max<std::int64_t>(1, config.counts_per_rev));
    for (const machine::SimulatedDrive& s : m_.simulation.drives)
      if (s.node == config.drive && !s.absolute_encoder) axis.start = s.start;
    axis.board = config.board.station;
    axis.channel = static_cast<std::size_t>(config.board.channel);
    if (config.board.present()) axis.start = amplifier_of(config).start;
    world_.add_axis(axis);
  }

  void add_station(const machine::StationConfig& station, int source) {
    if (station.over_bus()) return add_node_wires(station);
    if (!station.mock()) return;
    if (station.kind == machine::StationKind::gpio) return add_chip(station, source);
    if (station.kind == machine::StationKind::board) return add_board_wires(station);
    // A line stands where its first station does.
    const machine::LineConfig* line = m_.line(station.line);
    if (line != nullptr && stations_of_line(loaded_, line->name).front().station == &station) add_line(*line);
  }

  /// An input line of a chip: its contact follows a switch or is set.
  mock::GpioInput contact(const machine::PointConfig& p) const {
    mock::GpioInput input;
    input.name = p.name;
    input.rule = point_rule(p);
    if (p.is_encoder()) {
      input.source = mock::SetCounts{static_cast<std::int32_t>(initial(p.name).value_or(0.0))};
      return input;
    }
    input.source = mock::SetInput{initial(p.name).value_or(0.0) != 0.0};
    for (const machine::SimulatedSwitch& s : m_.simulation.switches) {
      if (s.point != p.name) continue;
      const int axis = m_.axis_index(s.axis);
      if (std::isinf(s.to))
        input.source = mock::LimitSwitch{axis, s.from, true};
      else if (std::isinf(s.from))
        input.source = mock::LimitSwitch{axis, s.to, false};
      else
        input.source = mock::HomeSwitch{axis, s.from, s.to - s.from};
    }
    return input;
  }

  void add_chip(const machine::StationConfig& station, int source) {
    std::vector<mock::GpioInput> inputs;
    std::vector<mock::GpioOutput> outputs;
    for (const machine::PointConfig& p : station.points)
      if (p.is_input())
        inputs.push_back(contact(p));
      else
        outputs.push_back({p.name, point_rule(p)});
    world_.add_chip(station.name, std::move(inputs), std::move(outputs), source);
  }

  machine::SimulatedAmplifier amplifier_of(const machine::AxisConfig& a) const {
    for (const machine::SimulatedAmplifier& s : m_.simulation.amplifiers)
      if (s.axis == a.letter) return s;
    return {};
  }

  /// The motor turns as the signs of the machine file say: rising counts are rising coordinates after
  /// `direction`.
  void add_board(const machine::StationConfig& station) {
    constexpr double kTurnsOfMinute = 60.0;
    mock::SimulatedBoardConfig config;
    config.serial = station.name;
    for (const machine::AxisConfig& a : m_.axes) {
      if (a.board.station != station.name) continue;
      const machine::SimulatedAmplifier s = amplifier_of(a);
      mock::AmplifierConfig& amplifier =
          config.amplifiers[static_cast<std::size_t>(a.board.channel)].emplace();
      amplifier.counts_per_rev = a.counts_per_rev;
      if (a.board.output == machine::BoardOutput::step)
        amplifier.steps_per_rev =
            a.board.feedback == machine::BoardFeedback::steps ? a.counts_per_rev : a.board.steps_per_rev;
      amplifier.pull_out = s.pull_out_speed / kTurnsOfMinute;
      amplifier.full_speed = a.board.full_speed / kTurnsOfMinute;
      amplifier.lag_s = s.lag;
      amplifier.drift = s.drift / 100.0;
      amplifier.reversed = a.board.reversed;
      if (const double turn = units_per_revolution(a); turn != 0.0) amplifier.start = s.start / turn;
      amplifier.zero_mark = s.zero_mark / static_cast<double>(std::max<std::int64_t>(1, a.counts_per_rev));
    }
    world_.add_board(station.name, config);
  }

  void add_board_wires(const machine::StationConfig& station) {
    std::vector<mock::NodeContact> inputs;
    std::vector<mock::WorldPoint> outputs;
    std::vector<std::pair<mock::WorldPoint, double>> values;
    for (const machine::PointConfig& p : station.points) {
      if (p.number < 0) continue;
      if (p.channel == machine::ChannelKind::di)
        inputs.push_back({contact(p), p.number});
      else if (p.channel == machine::ChannelKind::dq)
        outputs.push_back({p.name, point_rule(p), p.number});
      else if (p.channel == machine::ChannelKind::ai)
        values.push_back({{p.name, point_rule(p), p.number}, initial(p.name).value_or(0.0)});
    }
    world_.add_board_contacts(station.name, std::move(inputs), outputs, values);
  }

  void add_node_wires(const machine::StationConfig& station) {
    std::vector<mock::NodeContact> inputs;
    std::vector<mock::WorldPoint> outputs;
    for (const machine::PointConfig& p : station.points) {
      if (p.number < 0) continue;
      if (p.channel == machine::ChannelKind::ai)
        world_.add_value(station.node, {p.name, point_rule(p), p.number}, initial(p.name));
      else if (p.channel == machine::ChannelKind::di)
        inputs.push_back({contact(p), p.number});
      else if (p.channel == machine::ChannelKind::dq)
        outputs.push_back({p.name, point_rule(p), p.number});
    }
    world_.add_contacts(station.node, std::move(inputs), outputs);
  }

  mock::WorldUnit unit_of(const LineStation& line_station) const {
    const machine::StationConfig& station = *line_station.station;
    mock::WorldUnit unit{
        station.name, station_settings(station, line_station.layout), line_station.source, {}};
    if (line_station.inverter != nullptr) unit.settings.inverter = inverter_settings(line_station);
    for (const machine::PointConfig& p : station.points) {
      unit.points.push_back({p.name, point_rule(p), p.number});
      const double raw = initial(p.name).value_or(0.0);
      const auto n = static_cast<std::size_t>(p.number);
      if (p.channel == machine::ChannelKind::di && n < unit.settings.initial_inputs.size())
        unit.settings.initial_inputs[n] = raw != 0.0;
      if (p.channel == machine::ChannelKind::ai && n < unit.settings.initial_analog.size())
        unit.settings.initial_analog[n] = static_cast<std::uint16_t>(raw);
    }
    return unit;
  }

  void add_line(const machine::LineConfig& config) {
    const std::vector<LineStation> stations = stations_of_line(loaded_, config.name);
    mock::LineSettings line;
    line.baud = static_cast<std::uint32_t>(config.baud);
    line.answer_timeout_ns = nanoseconds(config.timeout);
    std::vector<mock::WorldUnit> units;
    for (const LineStation& station : stations) units.push_back(unit_of(station));
    world_.add_line(line, line_map(stations), std::move(units));
  }

  void add_indexer(const machine::SimulatedIndexer& config) {
    mock::WorldIndexer indexer{config.output, config.inputs, nanoseconds(config.step), 0};
    for (std::size_t n = 0; n < config.inputs.size(); ++n)
      if (initial(config.inputs[n]).value_or(0.0) != 0.0) indexer.start = static_cast<int>(n);
    world_.add_indexer(indexer);
  }

  const machine::LoadResult& loaded_;
  const machine::MachineConfig& m_;
  mock::World& world_;
};

}  // namespace

std::unique_ptr<mock::World> simulated_world(const machine::LoadResult& loaded) {
  auto world = std::make_unique<mock::World>();
  Setup(loaded, *world).all();
  return world;
}

}  // namespace servogate::gateway
