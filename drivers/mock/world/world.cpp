// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/world/world.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::mock {

namespace {

template <class Device>
Device* found(const std::map<std::string, std::unique_ptr<Device>, std::less<>>& devices,
              std::string_view name) {
  const auto at = devices.find(name);
  return at != devices.end() ? at->second.get() : nullptr;
}

template <class Device>
Device* found(const std::map<std::string, Device*, std::less<>>& devices, std::string_view name) {
  const auto at = devices.find(name);
  return at != devices.end() ? at->second : nullptr;
}

template <class Points>
std::size_t named(const Points& points, const std::string& name) {
  return static_cast<std::size_t>(
      std::ranges::find_if(points, [&](const auto& point) { return point.name == name; }) - points.begin());
}

}  // namespace

World::World() = default;
World::~World() = default;

void World::add_bus(const CanSegmentConfig& config) {
  auto segment = std::make_unique<CanSegment>(config);
  image::CanBus* control = &segment->add_endpoint("control");
  buses_.push_back({std::move(segment), control});
}

void World::add_outside_bus() { buses_.emplace_back(); }

void World::add_drive(const std::string& reference, const std::string& name,
                      const SimulatedDriveConfig& config) {
  auto device = std::make_unique<SimulatedDrive>(config);
  buses_.back().segment->attach(*device, name);
  drives_[reference] = std::move(device);
}

void World::add_module(const std::string& reference, const std::string& name,
                       const SimulatedIoConfig& config) {
  auto device = std::make_unique<SimulatedIoModule>(config);
  buses_.back().segment->attach(*device, name);
  modules_[reference] = std::move(device);
}

void World::add_encoder(const std::string& reference, const std::string& name,
                        const SimulatedEncoderConfig& config) {
  auto device = std::make_unique<SimulatedEncoder>(config);
  buses_.back().segment->attach(*device, name);
  encoders_[reference] = std::move(device);
}

void World::add_axis(const WorldAxis& axis) {
  const SimulatedBoard* on = board(axis.board);
  axes_.push_back({axis, drive(axis.drive), on != nullptr ? on->amplifier(axis.channel) : nullptr, 0});
}

void World::add_board(const std::string& station, const SimulatedBoardConfig& config) {
  boards_[station] = std::make_unique<SimulatedBoard>(config);
}

void World::add_board_contacts(const std::string& station, std::vector<NodeContact> inputs,
                               const std::vector<WorldPoint>& outputs,
                               const std::vector<std::pair<WorldPoint, double>>& values) {
  NodeWires wires{nullptr, nullptr, nullptr, board(station)};
  for (const WorldPoint& p : outputs)
    outputs_.push_back(
        {p.name, p.rule, {.board = wires.board, .number = static_cast<std::size_t>(p.channel)}});
  for (const auto& [point, raw] : values) {
    inputs_.push_back(
        {point.name, point.rule, {.board = wires.board, .number = static_cast<std::size_t>(point.channel)}});
    set_raw(inputs_.back().at, raw);
  }
  std::vector<GpioInput> contacts;
  for (NodeContact& input : inputs) {
    contacts.push_back(std::move(input.contact));
    wires.channels.push_back(input.channel);
  }
  wires.contacts = &add_contacts_of_chip(std::move(contacts), {}, -1);
  node_wires_.push_back(std::move(wires));
}

MockGpio& World::add_contacts_of_chip(std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs,
                                      int source) {
  const std::size_t first = inputs_.size();
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    Input input{inputs[n].name, inputs[n].rule, {.number = n}};
    input.switched = std::holds_alternative<LimitSwitch>(inputs[n].source) ||
                     std::holds_alternative<HomeSwitch>(inputs[n].source);
    inputs_.push_back(std::move(input));
  }
  const std::size_t first_output = outputs_.size();
  for (std::size_t n = 0; n < outputs.size(); ++n)
    outputs_.push_back({outputs[n].name, outputs[n].rule, {.number = n}});
  gpios_.push_back(std::make_unique<MockGpio>(
      std::move(inputs), std::move(outputs), [this](int axis) { return axis_position(axis); }, source));
  MockGpio& chip = *gpios_.back();
  for (std::size_t i = first; i < inputs_.size(); ++i) inputs_[i].at.chip = &chip;
  for (std::size_t i = first_output; i < outputs_.size(); ++i) outputs_[i].at.chip = &chip;
  return chip;
}

void World::add_chip(const std::string& station, std::vector<GpioInput> inputs,
                     std::vector<GpioOutput> outputs, int source) {
  chips_[station] = &add_contacts_of_chip(std::move(inputs), std::move(outputs), source);
}

void World::add_pendant(const std::string& name, pendant::Layout layout) {
  pendants_.emplace(name, std::make_unique<MockPendant>(std::move(layout)));
}

void World::add_contacts(const std::string& node, std::vector<NodeContact> inputs,
                         const std::vector<WorldPoint>& outputs) {
  NodeWires wires{nullptr, drive(node), module(node)};
  if (wires.drive == nullptr && wires.module == nullptr) return;
  for (const WorldPoint& p : outputs) {
    Output output{p.name, p.rule, {.number = static_cast<std::size_t>(p.channel)}};
    output.at.module = wires.module;
    output.at.drive = wires.module == nullptr ? wires.drive : nullptr;
    outputs_.push_back(std::move(output));
  }
  std::vector<GpioInput> contacts;
  for (NodeContact& input : inputs) {
    contacts.push_back(std::move(input.contact));
    wires.channels.push_back(input.channel);
  }
  wires.contacts = &add_contacts_of_chip(std::move(contacts), {}, -1);
  node_wires_.push_back(std::move(wires));
}

void World::add_value(const std::string& node, const WorldPoint& point, std::optional<double> initial) {
  Input input{point.name, point.rule, {.number = static_cast<std::size_t>(point.channel)}};
  input.at.module = module(node);
  input.at.encoder = point.channel == 0 ? encoder(node) : nullptr;
  if (input.at.module == nullptr && input.at.encoder == nullptr) return;
  if (initial) set_raw(input.at, *initial);
  inputs_.push_back(std::move(input));
}

void World::add_unit(const WorldUnit& unit, ModbusStation& station) {
  for (const WorldPoint& p : unit.points) {
    const Terminal at{.unit = &station, .number = static_cast<std::size_t>(p.channel)};
    const std::size_t inputs =
        p.rule.digital ? unit.settings.initial_inputs.size() : unit.settings.initial_analog.size();
    if (p.rule.input && at.number < inputs) inputs_.push_back({p.name, p.rule, at});
    if (!p.rule.input && p.rule.digital) outputs_.push_back({p.name, p.rule, at});
  }
}

void World::add_line(const LineSettings& line, const modbus::Map& map, std::vector<WorldUnit> units) {
  std::vector<StationSettings> settings;
  std::vector<int> sources;
  for (const WorldUnit& unit : units) {
    settings.push_back(unit.settings);
    sources.push_back(unit.source);
  }
  lines_.push_back(std::make_unique<MockModbusLine>(line, map, std::move(settings), sources));
  for (std::size_t n = 0; n < units.size(); ++n) {
    ModbusStation& station = lines_.back()->station(n);
    add_unit(units[n], station);
    units_[units[n].station] = &station;
    line_of_[units[n].station] = lines_.back().get();
  }
}

void World::add_indexer(const WorldIndexer& config) {
  std::vector<std::size_t> inputs;
  for (const std::string& name : config.inputs)
    if (const std::size_t input = named(inputs_, name); input < inputs_.size()) {
      inputs_[input].looped = true;
      inputs.push_back(input);
    }
  const std::size_t motor = named(outputs_, config.output);
  if (motor < outputs_.size() && inputs.size() == config.inputs.size())
    turrets_.push_back(
        {Indexer(static_cast<int>(inputs.size()), config.step_ns, config.start), motor, std::move(inputs)});
}

void World::add_loop(const WorldLoop& loop) {
  const std::size_t output = named(outputs_, loop.output), input = named(inputs_, loop.input);
  if (input < inputs_.size()) inputs_[input].looped = true;
  if (output >= outputs_.size() || input >= inputs_.size() || !inputs_[input].rule.digital) return;
  const Terminal &from = outputs_[output].at, &to = inputs_[input].at;
  if (from.unit != nullptr && from.unit == to.unit)
    from.unit->add_loopback({static_cast<std::uint16_t>(from.number), static_cast<std::uint16_t>(to.number),
                             loop.delay_ns, loop.inverted});
  else
    wires_.push_back({output, input, loop});
}

void World::advance_to(image::Nanoseconds t) {
  if (requested_.load(std::memory_order_acquire)) apply_requests();
  for (Turret& turret : turrets_) turn(turret, t);
  for (Wire& wire : wires_) carry(wire, t);
  for (const Bus& bus : buses_)
    if (bus.segment != nullptr) bus.segment->advance_to(t);
  for (const auto& [station, board] : boards_) board->advance_to(t);
  for (const auto& gpio : gpios_) gpio->advance_to(t);
  for (const NodeWires& wires : node_wires_) carry_contacts(wires);
  for (const auto& line : lines_) line->advance_to(t);
}

void World::carry_contacts(const NodeWires& wires) {
  using Side = DriveSwitch::Input;
  std::uint16_t general = 0;
  for (std::size_t n = 0; n < wires.channels.size(); ++n) {
    const bool on = wires.contacts->input(n);
    const int channel = wires.channels[n];
    if (wires.board != nullptr) {
      wires.board->set_input(static_cast<std::size_t>(channel), on, wires.contacts->changed_ns(n));
      continue;
    }
    if (wires.module != nullptr) {
      wires.module->set_digital(static_cast<std::uint8_t>(channel), on);
      continue;
    }
    // Bits of 60FDh. Source: CiA 402-2, object 60FDh.
    if (channel == 0) wires.drive->set_input(Side::negative_limit, on);
    if (channel == 1) wires.drive->set_input(Side::positive_limit, on);
    if (channel == 2) wires.drive->set_input(Side::home, on);
    if (channel == 3) wires.drive->set_interlock(on);
    if (channel >= 16 && on) general = static_cast<std::uint16_t>(general | 1u << (channel - 16));
  }
  if (wires.drive != nullptr) wires.drive->set_general_inputs(general);
}

void World::carry(Wire& wire, image::Nanoseconds t) {
  const bool now = level(outputs_[wire.output].at);
  if (wire.level != now) {
    wire.level = now;
    wire.since = t;
  }
  const Input& input = inputs_[wire.input];
  if (t - wire.since >= wire.loop.delay_ns && !input.held) set_level(input.at, now != wire.loop.inverted);
}

void World::turn(Turret& turret, image::Nanoseconds t) {
  turret.indexer.advance_to(t, is_on(outputs_[turret.motor]));
  const int position = turret.indexer.position();
  if (position == turret.shown) return;
  turret.shown = position;
  for (std::size_t i = 0; i < turret.inputs.size(); ++i)
    if (const Input& input = inputs_[turret.inputs[i]]; !input.held)
      set(input, static_cast<int>(i) == position);
}

void World::set_level(const Terminal& at, bool level) {
  if (at.chip != nullptr)
    at.chip->set_input(at.number, level);
  else
    at.unit->set_input(static_cast<std::uint16_t>(at.number), level);
}

void World::set_raw(const Terminal& at, double raw) {
  const auto within = [raw](double low, double high) { return std::llround(std::clamp(raw, low, high)); };
  const auto channel = static_cast<std::uint16_t>(at.number);
  if (at.board != nullptr)
    at.board->set_analog_input(at.number, static_cast<std::int16_t>(within(-32767.0, 32767.0)));
  else if (at.encoder != nullptr)
    at.encoder->set_position(within(-2147483648.0, 4294967295.0));
  else if (at.chip != nullptr)
    at.chip->set_counts(at.number, static_cast<std::int32_t>(within(-2147483648.0, 2147483647.0)));
  else if (at.module != nullptr)
    at.module->set_analogue(static_cast<std::uint8_t>(channel),
                            static_cast<std::int16_t>(within(-32768.0, 32767.0)));
  else
    at.unit->set_analog_input(channel, static_cast<std::uint16_t>(within(0.0, kLargestRegister)));
}

bool World::level(const Terminal& at) {
  if (at.board != nullptr) return at.board->output(at.number);
  if (at.module != nullptr) return at.module->digital(static_cast<std::uint8_t>(at.number));
  if (at.drive != nullptr) return (at.drive->digital_outputs() >> at.number & 1) != 0;
  return at.chip != nullptr ? at.chip->output(at.number)
                            : at.unit->output(static_cast<std::uint16_t>(at.number));
}

bool World::is_on(const Output& output) {
  return image::value_of(output.rule, level(output.at) ? 1.0 : 0.0) != 0.0;
}

/// False: a switch that follows its axis.
bool World::set(const Input& input, bool on) {
  const bool level = image::raw_of(input.rule, on ? 1.0 : 0.0) != 0.0;
  return input.at.chip != nullptr
             ? input.at.chip->set_input(input.at.number, level)
             : input.at.unit->set_input(static_cast<std::uint16_t>(input.at.number), level);
}

bool World::set_input(std::string_view point, bool on) {
  for (const Input& i : inputs_)
    if (i.name == point && i.rule.digital) return set(i, on);
  return false;
}

World::Played World::play_input(std::string_view point, Play play) {
  for (std::size_t n = 0; n < inputs_.size(); ++n) {
    if (inputs_[n].name != point) continue;
    if (!play.value && !inputs_[n].switched && !inputs_[n].looped) return Played::follows_nothing;
    const std::scoped_lock lock(requests_lock_);
    requests_.push_back({n, play});
    requested_.store(true, std::memory_order_release);
    return Played::done;
  }
  return Played::no_such_input;
}

void World::apply_requests() {
  const std::scoped_lock lock(requests_lock_);
  requested_.store(false, std::memory_order_relaxed);
  for (const Request& request : requests_) {
    const Input& i = inputs_[request.input];
    const double raw = image::raw_of(i.rule, request.play.value.value_or(0.0));
    if (!i.rule.digital)
      set_raw(i.at, raw);
    else if (i.looped)
      play_looped(request.input, request.play);
    else if (!i.switched)
      set_level(i.at, raw != 0.0);
    else if (request.play.value)
      i.at.chip->force_input(i.at.number, raw != 0.0);
    else
      i.at.chip->release_input(i.at.number);
  }
  requests_.clear();
}

/// What is played stays, whatever the output does; let go, the input shows at once what it should.
void World::play_looped(std::size_t input, const Play& play) {
  Input& i = inputs_[input];
  i.held = play.value.has_value();
  const bool raw = image::raw_of(i.rule, play.value.value_or(0.0)) != 0.0;
  const auto channel = static_cast<std::uint16_t>(i.at.number);
  if (i.at.chip != nullptr) {
    if (i.held) set_level(i.at, raw);
  } else if (i.held) {
    i.at.unit->hold_input(channel, raw);
  } else {
    i.at.unit->let_go_input(channel);
  }
  if (i.held) return;
  for (Turret& turret : turrets_)
    if (std::ranges::find(turret.inputs, input) != turret.inputs.end()) turret.shown = -2;
}

void World::close_operator_points() {
  for (const std::string& point : operator_points_) set_input(point, true);
}

SimulatedDrive* World::drive(std::string_view reference) { return found(drives_, reference); }
SimulatedIoModule* World::module(std::string_view reference) { return found(modules_, reference); }
SimulatedEncoder* World::encoder(std::string_view reference) { return found(encoders_, reference); }
ModbusStation* World::modbus(std::string_view station) { return found(units_, station); }
MockModbusLine* World::line_of(std::string_view station) { return found(line_of_, station); }
MockGpio* World::chip(std::string_view station) { return found(chips_, station); }
SimulatedBoard* World::board(std::string_view station) { return found(boards_, station); }
MockPendant* World::pendant(std::string_view name) { return found(pendants_, name); }

World::Contact World::contact(std::string_view point) {
  for (const Input& i : inputs_)
    if (i.name == point && i.at.chip != nullptr) return {i.at.chip, i.at.number, i.rule};
  return {};
}

void World::note_feedback(const image::ProcessImage& image) noexcept {
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (axes_[a].drive == nullptr && image.axes[a].drive.online)
      axes_[a].reported_counts = image.axes[a].drive.position_counts;
}

double World::axis_position(int axis) const {
  const Axis& a = axes_[static_cast<std::size_t>(axis)];
  const WorldAxis& s = a.settings;
  if (a.drive != nullptr) return a.drive->revolutions() * s.units_per_revolution;
  if (a.amplifier != nullptr) return a.amplifier->revolutions() * s.units_per_revolution;
  return s.start + static_cast<double>(a.reported_counts) / s.counts_per_revolution * s.units_per_revolution;
}

}  // namespace servogate::mock
