// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/status.hpp"

#include <chrono>
#include <cmath>
#include <span>

#include "gateway/control/run/standstill.hpp"
#include "gateway/control/run/words/alarm_entries.hpp"
#include "gateway/control/run/words/jog_words.hpp"
#include "machine/bus_place.hpp"

namespace servogate::gateway {

namespace {

constexpr std::string_view kTypedFile = "MDI";  ///< what the interpreter calls the file of typed blocks

std::vector<AlarmRow> alarm_rows(Resident& resident, text::Language language) {
  const cycle::AlarmSnapshot& alarms = resident.alarms();
  const std::span records(alarms.records.data(), static_cast<std::size_t>(alarms.count));
  std::vector<AlarmRow> rows;
  for (report::AlarmEntry& entry : alarm_entries(resident.control(), records, language)) {
    std::string reaction(image::words(entry.record.reaction, language));
    rows.push_back({std::move(entry), std::move(reaction)});
  }
  return rows;
}

/// File of the block in motion; a typed block is in none, but what it calls is.
std::string file_in_motion(Control& control, const image::ProcessStatus& p, int process) {
  if (p.line <= 0) return {};
  const std::string file = control.process(process).texts().file(p.run, p.file);
  return p.typed && file == kTypedFile ? std::string() : file;
}

std::optional<ProcessReport::Touched> touched(Control& control, int process) {
  const channel::Touches::Found found = control.process(process).touches();
  if (found.run == 0) return std::nullopt;
  const machine::AxisConfig& axis = control.machine().axes[static_cast<std::size_t>(found.axis)];
  ProcessReport::Touched out{axis.letter, found.places};
  for (double& place : out.places) place *= axis.diameter ? 2.0 : 1.0;
  return out;
}

ProcessReport process_report(Resident& resident, const image::ProcessImage& image, int process,
                             text::Language language) {
  Control& control = resident.control();
  const image::ProcessStatus& p = image.processes[static_cast<std::size_t>(process)];
  ProcessReport report;
  report.status = p;
  report.program = resident.program(process);
  report.blocks = resident.blocks(process);
  report.lines = resident.lines(process);
  if (p.typed) report.block = resident.manual_block(process);
  report.stop = stop_words(control, image, process, language);
  report.file = file_in_motion(control, p, process);
  if (!report.file.empty()) report.text = resident.line_of(process, report.file, p.line);
  report.message = program_message(control, image, process);
  report.wait = wait_words(control, image, process, language);
  report.touched = touched(control, process);
  return report;
}

/// As people read it: an endless axis within its turn, to the last digit that is shown.
double shown(const machine::AxisConfig& axis, double position) {
  constexpr double kTurn = 360.0, kHalfDigit = 0.5e-6;
  if (axis.diameter) return position * 2.0;
  if (!axis.endless()) return position;
  const double turn = position - kTurn * std::floor(position / kTurn);
  return turn < kTurn - kHalfDigit ? turn : 0.0;
}

AxisReport axis_report(const machine::AxisConfig& config, const image::AxisImage& a,
                       text::Language language) {
  const double across = config.diameter ? 2.0 : 1.0;
  AxisReport report;
  report.letter = config.letter;
  report.unit = config.unit();
  report.diameter = config.diameter;
  report.auxiliary = config.auxiliary;
  report.command = shown(config, a.command);
  report.position = shown(config, a.actual);
  report.axis = a;
  report.to_go = a.distance_to_go * across;
  report.beside = a.beside * across;
  if (a.jog_end != image::JogEnd::none) report.jog_end = jog_end_words(a.jog_end, config.letter, language);
  return report;
}

void put_gear(const machine::MachineConfig& m, text::Language language, std::size_t index,
              AxisReport& report) {
  const image::AxisGear& gear = report.axis.gear;
  int number = gear.number;
  for (const machine::ElectronicGearConfig& g : m.electronic_gears)
    if (g.follower == report.letter && --number == 0) report.gear_master = g.master;
  if (gear.refusal == 0) return;
  image::Answer answer;
  answer.refusal = gear.refusal;
  answer.axis = static_cast<std::int8_t>(index);
  answer.value = gear.refused_value;
  answer.limit = gear.refused_limit;
  report.gear_refusal = cycle::render(answer, m.letters(), language, m.unit_words());
}

std::vector<BusReport> bus_reports(const machine::MachineConfig& m, const image::ProcessImage& image) {
  std::vector<BusReport> buses;
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const machine::BusConfig& bus = m.buses[b];
    BusReport report{bus.name, bus.url, std::string(machine::bus_place(bus.url)), {}};
    for (const machine::NodeConfig& node : bus.nodes)
      report.nodes.push_back(
          {node.id, node.name, image.segments[b].nodes[static_cast<std::size_t>(node.id)]});
    buses.push_back(std::move(report));
  }
  return buses;
}

/// By what it is turned.
SpindleReport spindle_report(const machine::MachineConfig& m, const image::ProcessImage& image,
                             std::size_t index) {
  const machine::SpindleConfig& s = m.spindles[index];
  SpindleReport report;
  report.gears = !s.gears.empty();
  if (image.spindles[index].is_axis) report.axis = s.axis;
  const image::Place gear =
      image::at(image::field(image::kSpindleFields, "gear"), image::spindle_base(static_cast<int>(index)));
  if (const auto number = static_cast<std::size_t>(image.packets.number(gear));
      number > 0 && number <= s.gears.size())
    report.gear = s.gears[number - 1].name;
  if (!s.drive.empty()) {
    report.place = s.drive;
  } else if (!s.inverter.empty()) {
    report.supplier = SpindleSupplier::inverter;
    for (const machine::StationConfig& station : m.stations)
      if (station.name == s.inverter) report.place = station.line + "." + station.name;
  } else {
    report.supplier = SpindleSupplier::outputs;
    report.place = s.speed_output;
  }
  return report;
}

std::vector<ModbusLineReport> line_reports(const Control& control, const image::ProcessImage& image) {
  std::vector<ModbusLineReport> lines;
  for (const machine::LineConfig& line : control.machine().lines) {
    ModbusLineReport report{line.name, line.url, control.counters(line), {}};
    const std::vector<machine::StationConfig>& stations = control.machine().stations;
    for (std::size_t s = 0; s < stations.size(); ++s) {
      if (stations[s].kind != machine::StationKind::modbus || stations[s].line != line.name) continue;
      const image::IoSource& health = image.sources[s];
      report.units.push_back({stations[s].name, stations[s].unit, health,
                              static_cast<double>(image.now.t_ns - health.updated_ns) / 1e9});
    }
    lines.push_back(std::move(report));
  }
  return lines;
}

std::vector<ChipReport> chip_reports(const machine::MachineConfig& m, const image::ProcessImage& image) {
  std::vector<ChipReport> chips;
  for (std::size_t s = 0; s < m.stations.size(); ++s)
    if (m.stations[s].kind == machine::StationKind::gpio)
      chips.push_back({m.stations[s].name, m.stations[s].url, image.sources[s]});
  return chips;
}

std::vector<WorkReport> work_reports(Resident& resident) {
  std::vector<WorkReport> works;
  const auto now = std::chrono::steady_clock::now();
  for (const Works::Entry& w : resident.works().list())
    works.push_back({w.what, w.name, std::chrono::duration<double>(now - w.since).count()});
  return works;
}

}  // namespace

HeldBuses held_buses(const machine::MachineConfig& machine, const image::ProcessImage& image, bool run) {
  HeldBuses held{run, machine.name, bus_reports(machine, image), {}};
  for (const machine::LineConfig& line : machine.lines)
    if (!line.url.starts_with("mock:"))
      held.lines.push_back({line.name, line.url, machine::bus_place(line.url)});
  return held;
}

StatusReport status_report(Resident& resident, const PlcDesk& plc, text::Language language) {
  const image::ProcessImage& image = resident.image();
  const machine::MachineConfig& m = resident.control().machine();
  StatusReport status;
  status.machine = m.name;
  status.time_s = image.now.seconds();
  status.homing = image.homing;
  status.ending = resident.ending();
  status.language = language;
  for (int p = 0; p < image.process_count; ++p)
    status.processes.push_back(process_report(resident, image, p, language));
  std::vector<Resident::Coordinates> coordinates;
  for (int p = 0; p < image.process_count; ++p) {
    coordinates.push_back(resident.coordinates(p));
    status.processes[static_cast<std::size_t>(p)].corrector = coordinates.back().corrector;
    status.processes[static_cast<std::size_t>(p)].rotation_deg = coordinates.back().frame.rotation();
  }
  program::Position stands{};
  for (std::size_t a = 0; a < stands.size(); ++a) stands[a] = image.axes[a].actual;
  for (int i = 0; i < image.axis_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    status.homing = status.homing || image.axes[n].owner == image::AxisOwner::homing;
    if ((image.homing_left >> i & 1u) != 0) status.homing_left.push_back(m.axes[n].letter);
    status.axes.push_back(axis_report(m.axes[n], image.axes[n], language));
    put_gear(m, language, n, status.axes.back());
    const auto p = static_cast<std::size_t>(image.axes[n].process);
    if (m.axes[n].auxiliary || p >= coordinates.size()) continue;
    status.axes.back().work = shown(m.axes[n], coordinates[p].frame.to_programmed(stands, i));
    status.axes.back().origin = coordinates[p].origin[n];
  }
  for (int i = 0; i < image.spindle_count; ++i) {
    SpindleReport spindle = spindle_report(m, image, static_cast<std::size_t>(i));
    spindle.spindle = image.spindles[static_cast<std::size_t>(i)];
    if (!spindle_lost(image, m, i)) spindle.rests = spindle_rests(image, i);
    status.spindles.push_back(std::move(spindle));
  }
  status.buses = bus_reports(m, image);
  status.modbus = line_reports(resident.control(), image);
  status.chips = chip_reports(m, image);
  status.alarms = alarm_rows(resident, language);
  status.missing = missing_now(resident, language);
  status.works = work_reports(resident);
  status.forced = plc.forced();
  status.plc_held_by = plc.held_by();
  return status;
}

std::vector<MissingCondition> missing_now(Resident& resident, text::Language language) {
  const image::ProcessImage& image = resident.image();
  if (static_cast<std::size_t>(image.axis_count) != resident.control().machine().axes.size()) return {};
  return missing_for_power(resident.control(), image, resident.alarms(), language);
}

std::string alarms_in_words(Resident& resident, text::Language language) {
  const image::AlarmNames names = resident.control().alarm_names();
  const cycle::AlarmSnapshot& alarms = resident.alarms();
  std::string words;
  for (int i = 0; i < alarms.count; ++i) {
    const image::AlarmRecord& r = alarms.records[static_cast<std::size_t>(i)];
    words += (words.empty() ? "" : "; ") + std::to_string(r.number) + " " + image::render(r, names, language);
  }
  return words;
}

HistoryReport history_report(const history::EventLog* log, std::size_t count, text::Language language) {
  if (log == nullptr) return {{}, {}, language};
  return {log->last(count), log->problem(), language};
}

AlarmReport alarm_report(Resident& resident, text::Language language) {
  const image::ProcessImage& image = resident.image();
  AlarmReport report{alarm_rows(resident, language), {}, language};
  for (int p = 0; p < image.process_count; ++p)
    if (auto wait = wait_words(resident.control(), image, p, language)) report.waits.push_back(*wait);
  return report;
}

}  // namespace servogate::gateway
