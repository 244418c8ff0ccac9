// SPDX-License-Identifier: Apache-2.0
#include "machine/load.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/findings.hpp"
#include "machine/keys/sections.hpp"
#include "machine/loading/node_files.hpp"

namespace servogate::machine {

namespace {

namespace fs = std::filesystem;

/// Names of device files with the place that names them first.
std::vector<std::pair<std::string, Where>> device_names(const MachineConfig& machine) {
  std::vector<std::pair<std::string, Where>> out;
  const auto add = [&](const std::string& name, const std::string& path) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const auto& d) { return d.first == name; });
    if (!name.empty() && !known) out.emplace_back(name, machine.where(path));
  };
  for (std::size_t b = 0; b < machine.buses.size(); ++b)
    for (std::size_t n = 0; n < machine.buses[b].nodes.size(); ++n)
      add(machine.buses[b].nodes[n].device,
          "bus." + std::to_string(b) + ".node." + std::to_string(n) + ".device");
  for (std::size_t s = 0; s < machine.stations.size(); ++s)
    add(machine.stations[s].device, "station." + std::to_string(s) + ".device");
  for (std::size_t p = 0; p < machine.pendants.size(); ++p)
    add(machine.pendants[p].device, "pendant." + std::to_string(p) + ".device");
  return out;
}

std::vector<std::string> search_folders(const MachineConfig& machine) {
  const std::string own = fs::path(machine.file).parent_path().string();
  std::vector<std::string> out{own.empty() ? "." : own};
  out.push_back((fs::path(out[0]) / "devices").string());
  for (std::string& folder : device_folders()) out.push_back(std::move(folder));
  return out;
}

void load_devices(LoadResult& result, Reading& reading, std::vector<text::Finding>& of_devices) {
  const std::vector<std::string> folders = search_folders(result.machine);
  for (const auto& [name, at] : device_names(result.machine)) {
    std::string found, looked;
    for (const std::string& folder : folders) {
      const std::string path = (fs::path(folder) / (name + ".toml")).string();
      std::error_code error;
      if (found.empty() && fs::exists(path, error)) found = path;
      looked += (looked.empty() ? "" : ", ") + folder;
    }
    if (found.empty()) {
      reading.error(at, finding::kNoDevice, {name, looked});
      continue;
    }
    DeviceResult device = load_device(found);
    if (!device.ok()) reading.error(at, finding::kDeviceBroken, {found});
    of_devices.insert(of_devices.end(), device.findings.begin(), device.findings.end());
    result.devices.emplace(name, std::move(device.device));
  }
}

void check_all(LoadResult& result, Reading& reading) {
  MachineConfig& machine = result.machine;
  check_names(machine, reading);
  claim_control_outputs(machine, reading);
  check_references(machine, reading);
  check_places(machine, reading);
  check_axes(machine, reading);
  check_spindles(machine, reading);
  check_control(machine, reading);
  check_safety(machine, reading);
  check_modbus_server(machine, reading);
  check_pendants(result, reading);
  check_path_wheels(result, reading);
  check_gpio_lines(machine, reading);
  check_boards(machine, reading);
  check_gears(machine, reading);
  check_couplings(machine, reading);
  check_electronic_gears(machine, reading);
  check_spindle_axes(result, reading);
  check_devices(result, reading);
  check_station_devices(result, reading);
  check_inverters(result, reading);
  check_bus_times(result, reading);
  check_waits(result, reading);
  check_overrun(result, reading);
  check_control_death(result, reading);
  check_can_stations(result, reading);
}

}  // namespace

bool LoadResult::ok() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

const DeviceConfig* LoadResult::device(std::string_view name) const {
  const auto it = devices.find(name);
  return it == devices.end() ? nullptr : &it->second;
}

std::vector<std::string> device_folders() {
  std::vector<std::string> out;
  if (const char* folder = std::getenv("SERVOGATE_DEVICES"); folder != nullptr && *folder != '\0')
    out.emplace_back(folder);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share/servogate/devices";
  if (!error && fs::is_directory(installed, error)) {
    out.push_back(installed.string());
    return out;
  }
#ifdef SERVOGATE_DEVICE_FOLDER
  if (fs::is_directory(SERVOGATE_DEVICE_FOLDER, error)) out.emplace_back(SERVOGATE_DEVICE_FOLDER);
#endif
  return out;
}

LoadResult parse(std::string_view text, const std::string& path) {
  LoadResult result;
  Reading reading;
  reading.file = path;
  result.machine.file = path;
  std::vector<text::Finding> of_devices;
  if (read_file_text(text, section_of<MachineConfig>(), &result.machine, reading)) {
    result.machine.places = std::move(reading.places);
    result.machine.unread = std::move(reading.unread);
    load_devices(result, reading, of_devices);
    load_node_files(result, reading, of_devices);
    check_all(result, reading);
  }
  sort_findings(reading.findings);
  result.findings = std::move(reading.findings);
  sort_findings(of_devices);
  result.findings.insert(result.findings.end(), of_devices.begin(), of_devices.end());
  return result;
}

LoadResult load(const std::string& path) {
  std::string reason;
  if (const auto text = files::read_file(path, files::kMostOfSettings, reason)) return parse(*text, path);
  LoadResult result;
  result.readable = false;
  result.machine.file = path;
  result.findings.push_back({text::Severity::error, path, 1, 1, &finding::kFileMissing, {reason}});
  return result;
}

}  // namespace servogate::machine
