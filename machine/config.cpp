// SPDX-License-Identifier: Apache-2.0
#include "machine/config.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "firmware_if/text/units.hpp"

namespace servogate::machine {

std::string MachineConfig::resolve(std::string_view relative) const {
  return (std::filesystem::path(file).parent_path() / std::filesystem::path(relative)).string();
}

std::int64_t MachineConfig::cycle_ns() const { return std::llround(control.cycle_time * 1e9); }

int MachineConfig::axis_index(std::string_view letter) const {
  const auto it =
      std::find_if(axes.begin(), axes.end(), [&](const AxisConfig& a) { return a.letter == letter; });
  return it == axes.end() ? -1 : static_cast<int>(it - axes.begin());
}

int MachineConfig::spindle_index(std::string_view wanted) const {
  for (std::size_t s = 0; s < spindles.size(); ++s)
    if (wanted == (s == 0 ? "S" : "S" + std::to_string(s + 1))) return static_cast<int>(s);
  return -1;
}

const PointConfig* MachineConfig::point(std::string_view wanted, int* station) const {
  for (std::size_t s = 0; s < stations.size(); ++s)
    for (const PointConfig& p : stations[s].points)
      if (p.name == wanted) {
        if (station != nullptr) *station = static_cast<int>(s);
        return &p;
      }
  return nullptr;
}

const LineConfig* MachineConfig::line(std::string_view wanted, int* index) const {
  const auto it =
      std::find_if(lines.begin(), lines.end(), [&](const LineConfig& l) { return l.name == wanted; });
  if (it == lines.end()) return nullptr;
  if (index != nullptr) *index = static_cast<int>(it - lines.begin());
  return &*it;
}

const NodeConfig* MachineConfig::node(std::string_view reference, int* bus, int* index) const {
  const std::size_t dot = reference.find('.');
  if (dot == std::string_view::npos) return nullptr;
  for (std::size_t b = 0; b < buses.size(); ++b) {
    if (buses[b].name != reference.substr(0, dot)) continue;
    for (std::size_t n = 0; n < buses[b].nodes.size(); ++n)
      if (buses[b].nodes[n].name == reference.substr(dot + 1)) {
        if (bus != nullptr) *bus = static_cast<int>(b);
        if (index != nullptr) *index = static_cast<int>(n);
        return &buses[b].nodes[n];
      }
  }
  return nullptr;
}

bool MachineConfig::nothing_real(const StationConfig& station) const {
  if (!station.over_bus()) return station.mock();
  int bus = -1;
  return node(station.node, &bus) != nullptr && buses[static_cast<std::size_t>(bus)].nothing_real();
}

bool MachineConfig::nothing_real() const {
  return std::all_of(buses.begin(), buses.end(), [](const BusConfig& b) { return b.nothing_real(); }) &&
         std::all_of(stations.begin(), stations.end(), [](const StationConfig& s) { return s.mock(); });
}

bool MachineConfig::virtual_time() const {
  return std::all_of(buses.begin(), buses.end(), [](const BusConfig& b) { return b.mock() || b.lockstep(); });
}

std::vector<std::string> MachineConfig::letters() const {
  std::vector<std::string> out;
  for (const AxisConfig& a : axes) out.push_back(a.letter);
  return out;
}

std::vector<std::string> MachineConfig::unit_words() const {
  std::vector<std::string> out;
  for (const AxisConfig& a : axes) out.push_back(text::unit_words(a.unit()));
  return out;
}

std::size_t MachineConfig::program_axes() const {
  return static_cast<std::size_t>(
      std::count_if(axes.begin(), axes.end(), [](const AxisConfig& a) { return !a.auxiliary; }));
}

std::uint32_t MachineConfig::axes_of_process(int process) const {
  std::uint32_t bits = 0;
  for (std::size_t a = 0; a < program_axes() && a < image::kMaxAxes; ++a)
    if (axes[a].process == process + 1) bits |= std::uint32_t{1} << a;
  return bits;
}

const SpindleConfig* MachineConfig::spindle_of_process(int process) const {
  const auto found = std::find_if(spindles.begin(), spindles.end(),
                                  [process](const SpindleConfig& s) { return s.process == process + 1; });
  return found == spindles.end() ? nullptr : &*found;
}

std::uint32_t MachineConfig::auxiliary_axes() const {
  std::uint32_t bits = 0;
  for (std::size_t a = 0; a < axes.size() && a < image::kMaxAxes; ++a)
    if (axes[a].auxiliary) bits |= std::uint32_t{1} << a;
  return bits;
}

std::vector<image::Symbol> MachineConfig::symbol_table() const {
  std::vector<image::Symbol> out = image::interface_symbols(
      control.processes, letters(), static_cast<int>(spindles.size()), auxiliary_axes());
  for (const StationConfig& s : stations)
    for (const PointConfig& p : s.points) out.push_back({p.name, p.place, p.writer, p.comment});
  // The shipped PLC programs need not know how the machine builder calls it.
  if (const PointConfig* chain = point(safety.estop); chain != nullptr)
    out.push_back({"MC.estop_chain", chain->place, chain->writer, chain->comment});
  for (const SymbolConfig& s : symbols) out.push_back({s.name, s.place, s.writer, s.comment});
  return out;
}

}  // namespace servogate::machine
