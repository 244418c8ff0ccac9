// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/control.hpp"
#include "gateway/control/compose/open_bus.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "firmware_if/canopen/301/emcy.hpp"
#include "gateway/control/compose/alarms/source_names.hpp"
#include "gateway/control/compose/plc/compile_beside.hpp"
#include "gateway/control/compose/plc/logic_options.hpp"
#include "gateway/control/compose/program/program_model.hpp"
#include "gateway/control/compose/setup/axis_setup.hpp"
#include "gateway/control/compose/setup/canopen_setup.hpp"
#include "machine/files/read_file.hpp"
#include "plc/compile/compile.hpp"

namespace servogate::gateway {

namespace {

/// Far more than any cycle, and less than anybody waits for a stop.
constexpr image::Nanoseconds kLongestScan_ns = 500 * image::kMillisecond;

/// Stands in for a bus while a record is replayed: what came in comes from the record.
class SilentBus final : public image::CanBus {
 public:
  explicit SilentBus(std::uint32_t bit_rate) : bit_rate_(bit_rate) {}
  bool send(const image::CanFrame&) noexcept override { return true; }
  bool receive(image::CanFrame&) noexcept override { return false; }
  image::CanState state() const noexcept override { return image::CanState::error_active; }
  std::uint32_t bit_rate() const noexcept override { return bit_rate_; }

 private:
  std::uint32_t bit_rate_;
};
const text::Entry kNotRestored{
    "compose.plc-not-restored",
    "the retained value {2} of '{0}' is kept aside: the PLC has no such variable of type {1}",
    "сохранённое значение {2} переменной «{0}» отложено: в ПЛК нет такой переменной типа {1}"};
const text::Entry kUnreadable{"compose.plc-unreadable", "cannot read the PLC source: {0}",
                              "исходный текст ПЛК не читается: {0}"};

}  // namespace

Control::Control(const machine::LoadResult& loaded)
    : loaded_(loaded),
      symbols_(loaded_.machine.symbol_table()),
      meeting_(loaded_.machine.control.processes),
      programs_(static_cast<std::size_t>(loaded_.machine.control.processes)) {}
Control::~Control() = default;

std::unique_ptr<Control> Control::compose(const machine::LoadResult& loaded,
                                          std::vector<text::Finding>& findings, cycle::InputSource* source) {
  std::unique_ptr<Control> c(new Control(loaded));
  c->replay_ = source != nullptr;
  const machine::MachineConfig& m = c->loaded_.machine;
  const bool logic = c->compile_logic(findings), devices = check_devices(c->loaded_, findings);
  if (!logic || !devices || !c->open_buses(findings, source != nullptr)) return nullptr;

  c->world_ = simulated_world(c->loaded_);
  c->devices_ = open_devices(c->loaded_, *c->world_, source != nullptr, findings);
  if (infrastructure(findings)) return nullptr;
  c->faults_ = std::make_unique<MachineFaults>(m, *c->world_, true);
  c->alarm_rooms_ = c->alarm_rooms();
  cycle::CycleParts parts;
  parts.alarms = &c->alarm_rooms_->table();
  parts.period_ns = m.cycle_ns();
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    image::CanBus* bus = m.buses[b].mock() ? c->world_->bus(b) : c->transports_[b].bus.get();
    c->taps_.push_back(std::make_unique<BusTap>(*bus, static_cast<int>(b)));
    c->suppliers_.push_back(std::make_unique<CanSupplier>(
        *c->taps_.back(), segment_config(c->loaded_, static_cast<int>(b)), drive_points(m, m.buses[b].name)));
    parts.devices.push_back(c->suppliers_.back().get());
    for (const canopen::NodeConfig& node : c->suppliers_.back()->segment().config().nodes)
      if (node.target == canopen::DriveTarget::io)
        parts.sources[static_cast<std::size_t>(node.target_index)].place = {static_cast<std::int16_t>(b),
                                                                            node.node};
  }
  for (const OpenDevice& device : c->devices_) parts.devices.push_back(device.device.get());
  for (std::size_t s = 0; s < m.stations.size(); ++s)
    parts.sources[s].watched = !m.stations[s].over_bus() && !turns_spindle(m, m.stations[s]);
  parts.logic = c->logic_.get();
  for (int p = 0; p < m.control.processes; ++p) {
    channel::ProcessConfig config = process_config(m, p);
    config.meeting = &c->meeting_;
    config.supplier = [control = c.get()](int from, int to, const std::string& name) {
      return control->supply(from, to, name);
    };
    c->processes_.push_back(std::make_unique<channel::Process>(config));
    parts.processes.push_back(c->processes_.back().get());
  }
  for (const machine::AxisConfig& a : m.axes) parts.axes.push_back(axis_config(c->loaded_, a));
  for (const machine::SpindleConfig& s : m.spindles) parts.spindles.push_back(spindle_config(c->loaded_, s));
  parts.k_bytes = static_cast<std::uint32_t>(m.control.k_size);
  parts.syvar_bytes = static_cast<std::uint32_t>(m.control.syvar_size);
  if (const machine::PointConfig* estop = m.point(m.safety.estop); estop != nullptr)
    parts.estop_place = estop->place;
  if (const machine::PointConfig* alive = m.point(m.safety.control_alive); alive != nullptr)
    parts.alive_place = alive->place;
  if (const machine::PointConfig* start = m.point(m.run.start_point); start != nullptr)
    parts.start_place = start->place;
  for (const machine::PathWheelConfig& w : m.path_wheels) {
    cycle::PathWheelConfig& wheel = parts.path_wheels[static_cast<std::size_t>(w.process - 1)];
    wheel.source = w.handwheel();
    wheel.full = w.full_speed;
    if (const machine::PointConfig* healthy = m.point(w.healthy); healthy != nullptr)
      wheel.healthy = healthy->place;
  }
  for (const machine::ElectronicGearConfig& g : m.electronic_gears) parts.gears.push_back(gear_config(m, g));
  parts.stopwatch = &c->stopwatch_;
  c->cycle_ = std::make_unique<cycle::Cycle>(std::move(parts));
  c->cycle_->attach(source);
  return c;
}

bool Control::open_buses(std::vector<text::Finding>& findings, bool replay) {
  const machine::MachineConfig& m = loaded_.machine;
  bool good = true;
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const machine::BusConfig& bus = m.buses[b];
    const auto rate = static_cast<std::uint32_t>(bus.bit_rate);
    transports_.emplace_back();
    if (bus.mock()) continue;
    if (replay) {
      transports_.back().bus = std::make_unique<SilentBus>(rate);
      continue;
    }
    if (auto opened = open_bus(m, b, findings))
      transports_.back() = std::move(*opened);
    else
      good = false;
  }
  return good;
}

bool Control::infrastructure(const std::vector<text::Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const auto& f) { return bus_not_opened(f) || device_not_opened(f); });
}

const CanTransport* Control::shared_bus(std::size_t bus) const noexcept {
  const CanTransport& t = transports_[bus];
  return t.bus != nullptr && t.descriptor >= 0 && t.lockstep == nullptr ? &t : nullptr;
}

std::optional<modbus::LineCounters> Control::counters(const machine::LineConfig& line) const noexcept {
  for (const OpenDevice& d : devices_)
    if (d.line == &line && d.counters != nullptr) return d.counters->counters();
  return std::nullopt;
}

std::uint64_t Control::frames_lost(std::size_t bus) const noexcept {
  return transports_[bus].bus != nullptr ? transports_[bus].bus->lost() : 0;
}

/// Time that other processes live in goes on to the beginning of the next cycle, with everything that happens
/// until then.
void Control::await_grants(image::Nanoseconds t) {
  for (bool more = true; more;) {
    more = false;
    for (CanTransport& transport : transports_)
      if (transport.lockstep != nullptr && (t > 0 || transport.lockstep->granted() > 0))
        transport.lockstep->done(t);
    for (CanTransport& transport : transports_) {
      if (transport.lockstep == nullptr) continue;
      const auto granted = transport.lockstep->wait_grant();
      more = more || (granted && *granted < t);
    }
  }
}

void Control::watch_logic() noexcept {
  if (logic_ != nullptr && logic_->scan_ended())
    cycle_->watch_logic(longest_scan_ns(), true);
  else
    cycle_->watch_logic(static_cast<image::Nanoseconds>(loaded_.machine.plc.watchdog * 1e9));
}

image::Nanoseconds Control::longest_scan_ns() const noexcept {
  return std::max(kLongestScan_ns, static_cast<image::Nanoseconds>(loaded_.machine.plc.watchdog * 1e9));
}

plc::CompileResult Control::compile(const std::vector<plc::SourceFile>& files,
                                    const std::stop_token& stop) const {
  return compile_beside(files, symbols_, logic_options(loaded_.machine), stop);
}

plc::Logic::Plan Control::prepare(const plc::LogicChange& change, plc::CompileResult compiled) {
  plc::Logic::Plan plan = logic_->prepare(change, std::move(compiled));
  if (plan.possible && change_tap_ != nullptr) change_tap_->take(change);
  return plan;
}

bool Control::compile_logic(std::vector<text::Finding>& findings) {
  const machine::MachineConfig& m = loaded_.machine;
  if (m.plc.sources.empty()) return true;
  std::vector<plc::SourceFile> sources;
  for (std::size_t i = 0; i < m.plc.sources.size(); ++i) {
    plc::SourceFile file{m.resolve(m.plc.sources[i]), {}};
    std::string error;
    auto content = files::read_file(file.name, files::kMostOfSource, error);
    if (!content) {
      const machine::Where where = m.where("plc.sources");
      findings.push_back({text::Severity::error,
                          m.file,
                          where.line,
                          where.column,
                          &kUnreadable,
                          {file.name + ": " + error}});
      return false;
    }
    file.text = std::move(*content);
    sources.push_back(std::move(file));
  }
  plc::CompileResult compiled = plc::compile(sources, symbols_, logic_options(m));
  findings.insert(findings.end(), compiled.findings.begin(), compiled.findings.end());
  if (!compiled.ok()) return false;
  logic_ = std::make_unique<plc::Logic>(compiled.image, std::move(sources), stopwatch_);
  return true;
}

image::Nanoseconds Control::advance_world() {
  const image::Nanoseconds t = cycle_->count() * cycle_->period_ns();
  faults_->advance_to(t);
  const image::Nanoseconds late = faults_->take_lateness();
  world_ahead_ns_ += late;
  await_grants(t + world_ahead_ns_);
  world_->note_feedback(cycle_->image());
  world_->advance_to(t + world_ahead_ns_);
  return late;
}

void Control::take_leave() {
  constexpr image::Nanoseconds kPatience_ns = 500 * image::kMillisecond;
  const image::Nanoseconds begin = cycle_->count() * cycle_->period_ns();
  const bool granted = std::any_of(transports_.begin(), transports_.end(),
                                   [](const CanTransport& t) { return t.lockstep != nullptr; });
  bool done = false;
  for (image::Nanoseconds t = begin; !done && t < begin + kPatience_ns; t += cycle_->period_ns()) {
    if (granted)
      await_grants(t + world_ahead_ns_);
    else
      std::this_thread::sleep_for(std::chrono::nanoseconds(cycle_->period_ns()));
    done = true;
    for (const auto& supplier : suppliers_) {
      const auto bus = static_cast<std::size_t>(supplier->segment().config().index);
      if (transports_[bus].bus != nullptr) done = supplier->leave(t) && done;
    }
  }
}

bool Control::read_ahead() {
  const std::scoped_lock lock(reading_);
  bool more = false;
  for (const auto& process : processes_) more = process->work() || more;
  return more;
}

void Control::read_with(std::unique_ptr<RoundWorker> worker) {
  beside_ = std::make_unique<ReadingBeside>(processes_, reading_, cycle_->period_ns(), std::move(worker));
}

/// What stands behind a round does not depend on when it is looked at.
std::unique_lock<std::mutex> Control::stop_reading() {
  if (beside_ != nullptr) beside_->wait();
  return std::unique_lock(reading_);
}

bool Control::change(const ProgramChange& change) {
  const auto lock = stop_reading();
  return carry_out(change);
}

std::shared_ptr<const ProgramFile> Control::take_given(int process) {
  const auto lock = stop_reading();
  Program& program = programs_[static_cast<std::size_t>(process)];
  return std::exchange(program.given, false) ? program.file : nullptr;
}

std::optional<program::Tables> Control::given_tables(int process) {
  const auto lock = stop_reading();
  return programs_[static_cast<std::size_t>(process)].tables;
}

/// Called while processes read ahead. In a replay the record makes the change.
channel::Supply Control::supply(int from, int to, const std::string& name) {
  const std::shared_ptr<const ProgramFile> caller = programs_[static_cast<std::size_t>(from)].file;
  if (process(to).feeder().reads()) return channel::Supply::busy;
  if (caller == nullptr || !caller->loader) return channel::Supply::not_found;
  std::optional<program::LoadedProgram> loaded = load_for(*caller, name, change_tap_);
  if (!loaded) return channel::Supply::not_found;
  if (replay_) return channel::Supply::given;
  auto file = std::make_shared<ProgramFile>();
  file->path = loaded->path.empty() ? name : loaded->path;
  file->dialect = caller->dialect;
  file->text = program::ProgramText(std::move(loaded->text));
  file->process = to;
  file->model = program_model(machine(), to);
  file->loader = caller->loader;
  const program::Tables* tables = process(from).feeder().tables();
  program::Tables as_they_stand = tables != nullptr ? *tables : program::Tables{};
  carry_out({ProgramChange::Kind::program, to, std::move(file), as_they_stand, {}});
  programs_[static_cast<std::size_t>(to)].given = true;
  programs_[static_cast<std::size_t>(to)].tables = std::move(as_they_stand);
  return channel::Supply::given;
}

bool Control::carry_out(const ProgramChange& change) {
  channel::Process& p = process(change.process);
  const bool loads = change.kind == ProgramChange::Kind::program ||
                     change.kind == ProgramChange::Kind::tables ||
                     change.kind == ProgramChange::Kind::restart;
  if (loads && p.feeder().reads()) return false;
  // What a record keeps of it lies before what its subprograms are.
  if (change_tap_ != nullptr) change_tap_->take(change);
  if (change.file != nullptr) programs_[static_cast<std::size_t>(change.process)] = {change.file, false, {}};
  switch (change.kind) {
    case ProgramChange::Kind::program:
      p.load(interpreter_factory(change, change_tap_), change.tables);
      break;
    case ProgramChange::Kind::tables:
      programs_[static_cast<std::size_t>(change.process)].tables.reset();
      p.renew(interpreter_factory(change, change_tap_), change.tables);
      break;
    case ProgramChange::Kind::restart:
      p.restart(restart_factory(change, change_tap_));
      break;
    case ProgramChange::Kind::block:
      p.set_manual_block(change.block);
      break;
    case ProgramChange::Kind::touch:
      if (const auto order = channel::touch_from(change.block)) p.set_touch(*order);
      break;
    case ProgramChange::Kind::modes:
      p.forget_manual();
      break;
  }
  return true;
}

void Control::restore_references(const machine::MachineState& state) {
  const std::vector<machine::AxisConfig>& axes = loaded_.machine.axes;
  for (std::size_t a = 0; a < axes.size(); ++a)
    if (const auto kept = state.homing.find(axes[a].letter);
        kept != state.homing.end() && kept->second.valid &&
        axes[a].home.method == machine::HomingMethod::absolute)
      cycle_->set_reference(static_cast<int>(a), kept->second.offset_counts);
}

void Control::restore_tool(const machine::MachineState& state) {
  cycle_->initial_image().processes[static_cast<std::size_t>(machine().tool_process())].tool =
      static_cast<std::uint16_t>(state.tool_in_spindle);
}

std::vector<text::Finding> Control::restore_retained(const machine::MachineState& state) {
  std::vector<text::Finding> findings;
  for (const machine::RetainedVariable& v : state.retained) {
    const plc::Retained value{v.name, v.type, v.value};
    if (logic_ != nullptr && logic_->engine().restore({&value, 1}) != 0) continue;
    if (logic_ != nullptr) logic_->set_aside(value);
    const machine::Where where = loaded_.machine.where("plc");
    findings.push_back({text::Severity::warning,
                        loaded_.machine.file,
                        where.line,
                        where.column,
                        &kNotRestored,
                        {v.name, v.type, v.value}});
  }
  return findings;
}

void Control::open_cycle(const image::Clock& clock, image::Nanoseconds due_ns) noexcept {
  if (!due_ns_)
    for (const auto& supplier : suppliers_) supplier->time_sync(clock);
  due_ns_ = due_ns;
}

/// The device file of the drive or part that an alarm is of.
const machine::DeviceConfig* Control::device_of(const image::AlarmRecord& r) const {
  if (r.source >= 0 && r.part.device < 0)
    return loaded_.device(loaded_.machine.stations[static_cast<std::size_t>(r.source)].device);
  const machine::NodeConfig* node = node_of(r.part);
  return node != nullptr ? loaded_.device(node->device) : nullptr;
}

const machine::NodeConfig* Control::node_of(const image::PartPlace& place) const {
  if (place.device < 0 || place.device >= std::ssize(loaded_.machine.buses)) return nullptr;
  for (const machine::NodeConfig& n : loaded_.machine.buses[static_cast<std::size_t>(place.device)].nodes)
    if (n.id == place.part) return &n;
  return nullptr;
}

std::unique_ptr<AlarmRooms> Control::alarm_rooms() const {
  const auto process = [this](int p) {
    return p >= 0 && p < std::ssize(processes_) ? processes_[static_cast<std::size_t>(p)].get() : nullptr;
  };
  canopen::MasterAlarmWords bus([this](const image::PartPlace& place) {
    const machine::NodeConfig* node = node_of(place);
    return node != nullptr ? node->software_version : std::string();
  });
  channel::ProgramAlarmWords program(
      [process](int p, std::uint32_t run, int file) {
        return process(p) != nullptr ? process(p)->texts().file(run, file) : std::string();
      },
      [process](int p, int number, text::Language language) {
        const auto finding = process(p) != nullptr ? process(p)->texts().finding(number) : std::nullopt;
        return finding ? finding->str(language) : std::string();
      });
  plc::LogicAlarmWords logic([this](const image::AlarmRecord& record, text::Language language) {
    return logic_ != nullptr ? logic_->fault_words(record, language) : std::string();
  });
  return std::make_unique<AlarmRooms>(std::move(bus), std::move(program), std::move(logic));
}

image::AlarmNames Control::alarm_names() const {
  const machine::MachineConfig& m = loaded_.machine;
  image::AlarmNames names;
  names.table = &alarm_rooms_->table();
  names.axes = m.letters();
  names.units = m.unit_words();
  for (const machine::AxisConfig& a : m.axes) names.diameters.push_back(a.diameter);
  for (const machine::BusConfig& b : m.buses) names.devices.push_back(b.name);
  for (const machine::StationConfig& s : m.stations) names.sources.push_back(source_name(m, s));
  for (const machine::StationConfig& s : m.stations) names.devices.push_back(s.name);  // behind the buses
  names.error_text = [this](const image::AlarmRecord& r, std::uint16_t code, text::Language language) {
    if (on_board(loaded_.machine, r.part)) return board_words(code, language);
    const machine::DeviceConfig* device = device_of(r);
    if (device != nullptr && device->kind == machine::DeviceKind::inverter)
      return inverter_words(*device, r.number, code, language);
    const std::string_view own = device != nullptr ? device->error_text(code, language) : std::string_view();
    return own.empty() ? text::render(canopen::error_code_text(code), {}, language) : std::string(own);
  };
  names.part_name = [this](const image::PartPlace& place) {
    if (on_board(loaded_.machine, place)) return board_channel_name(loaded_.machine, place);
    const machine::NodeConfig* n = node_of(place);
    return n == nullptr ? std::string()
                        : loaded_.machine.buses[static_cast<std::size_t>(place.device)].name + "." + n->name;
  };
  return names;
}

}  // namespace servogate::gateway
