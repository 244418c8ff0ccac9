// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/open_devices.hpp"

#include <algorithm>

#include "gateway/control/compose/devices/device_table.hpp"
#include "gateway/control/compose/simulated/world_setup.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNoDriver{"compose.no-driver", "{0} '{1}': nothing opens '{2}'; possible are {3}",
                            "{0} «{1}»: «{2}» ничем не открывается; возможны {3}"};
const text::Entry kNotOpened{"compose.not-opened", "{0} '{1}': {2}", "{0} «{1}»: {2}"};

/// A device of the machine file.
struct Place {
  DeviceKind kind;
  std::string path;  ///< of its url in the machine file
  std::string name, url;
  std::size_t station;
  const machine::LineConfig* line;
};

std::vector<Place> places_of(const machine::MachineConfig& m) {
  std::vector<Place> places;
  for (std::size_t s = 0; s < m.stations.size(); ++s) {
    const machine::StationConfig& station = m.stations[s];
    if (station.over_bus()) continue;
    const bool board = station.kind == machine::StationKind::board;
    if (station.kind == machine::StationKind::gpio || board) {
      places.push_back({board ? DeviceKind::board : DeviceKind::chip, "station." + std::to_string(s) + ".url",
                        station.name, station.url, s, nullptr});
      continue;
    }
    int index = -1;
    const machine::LineConfig* line = m.line(station.line, &index);
    if (line == nullptr || std::ranges::any_of(places, [&](const Place& p) { return p.line == line; }))
      continue;
    places.push_back(
        {DeviceKind::line, "line." + std::to_string(index) + ".url", line->name, line->url, s, line});
  }
  return places;
}

text::Finding finding(const machine::MachineConfig& m, const Place& place, const text::Entry& entry,
                      std::vector<std::string> arguments) {
  const machine::Where where = m.where(place.path);
  const std::string kind =
      place.kind == DeviceKind::line ? text::both("line", "линия") : text::both("station", "станция");
  arguments.insert(arguments.begin(), {kind, place.name});
  return {text::Severity::error, m.file, where.line, where.column, &entry, std::move(arguments)};
}

/// Stands in for a real device while a record is replayed.
class ClosedDevice final : public image::CycleDevice {
 public:
  void receive(image::ProcessImage&, image::Notices&) noexcept override {}
  void send(image::ProcessImage&) noexcept override {}
};

}  // namespace

bool check_devices(const machine::LoadResult& loaded, std::vector<text::Finding>& findings) {
  const machine::MachineConfig& m = loaded.machine;
  bool good = true;
  for (const Place& place : places_of(m)) {
    if (place.url.empty() || device_row(place.kind, place.url) != nullptr) continue;
    findings.push_back(finding(m, place, kNoDriver, {place.url, device_forms(place.kind)}));
    good = false;
  }
  return good;
}

void probe_devices(const machine::LoadResult& loaded, std::vector<text::Finding>& findings) {
  const auto world = simulated_world(loaded);  // of the simulated ones
  mock::World nothing;
  for (const Place& place : places_of(loaded.machine)) {
    const DeviceRow* row = device_row(place.kind, place.url);
    if (row == nullptr || row->available == nullptr) continue;
    drivers::Notice why;
    const std::string_view rest = std::string_view(place.url).substr(row->scheme.size());
    if (row->available({loaded, *world, place.station, place.line, rest}, why)) continue;
    findings.push_back(
        finding(loaded.machine, place, kNotOpened,
                {text::both(why.str(text::Language::english), why.str(text::Language::russian))}));
  }
}

std::vector<OpenDevice> open_devices(const machine::LoadResult& loaded, mock::World& world, bool replay,
                                     std::vector<text::Finding>& findings) {
  std::vector<OpenDevice> devices;
  for (const Place& place : places_of(loaded.machine)) {
    const DeviceRow* row = device_row(place.kind, place.url);
    if (row == nullptr) continue;  // said by check_devices()
    if (replay && !row->simulated) {
      devices.push_back({std::make_unique<ClosedDevice>(), place.line, nullptr});
      continue;
    }
    drivers::Notice why;
    const std::string_view rest = std::string_view(place.url).substr(row->scheme.size());
    auto device = row->open({loaded, world, place.station, place.line, rest}, why);
    if (device != nullptr) {
      const auto* counters = dynamic_cast<const modbus::CountedLine*>(device.get());
      devices.push_back({std::move(device), place.line, counters});
      continue;
    }
    findings.push_back(
        finding(loaded.machine, place, kNotOpened,
                {text::both(why.str(text::Language::english), why.str(text::Language::russian))}));
  }
  return devices;
}

bool device_not_opened(const text::Finding& finding) { return finding.entry == &kNotOpened; }

}  // namespace servogate::gateway
