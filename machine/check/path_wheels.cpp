// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "machine/check/check.hpp"
#include "machine/check/findings_pendant.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::machine {

namespace {

/// nullptr: none is called so, or its device file is not there, which is said elsewhere.
const DeviceConfig* device_of(const LoadResult& loaded, const PendantConfig& pendant) {
  const DeviceConfig* device = loaded.device(pendant.device);
  return device != nullptr && device->kind == DeviceKind::pendant ? device : nullptr;
}

void source_of(const LoadResult& loaded, const PathWheelConfig& w, const std::string& path,
               Reading& reading) {
  const MachineConfig& m = loaded.machine;
  const PointConfig* point = w.healthy.empty() ? nullptr : m.point(w.healthy);
  if (point != nullptr && (point->hold || point->loss != 0.0))
    reading.error(m.where(path + ".healthy"), finding::kPathWheelLoss, {point->name});
  if (w.handwheel() != 0) return;
  std::string names;
  const PendantConfig* pendant = nullptr;
  for (const PendantConfig& p : m.pendants) {
    names += (names.empty() ? "" : ", ") + p.name;
    if (p.name == w.source) pendant = &p;
  }
  if (pendant == nullptr)
    return reading.error(m.where(path + ".source"), finding::kPathWheelSource,
                         {w.source, names.empty() ? "-" : names});
  if (!w.healthy.empty())
    reading.error(m.where(path + ".healthy"), finding::kPathWheelHealthy, {pendant->name});
  if (const DeviceConfig* device = device_of(loaded, *pendant);
      device != nullptr && device->pendant.wheel < 0)
    reading.error(m.where(path + ".source"), finding::kPathWheelNone, {pendant->name});
}

/// A button that chooses the wheel of a pendant which drives nothing.
void buttons_of(const LoadResult& loaded, const PendantConfig& p, const std::string& path, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  const DeviceConfig* device = device_of(loaded, p);
  if (device == nullptr) return;
  const bool drives = std::any_of(m.path_wheels.begin(), m.path_wheels.end(),
                                  [&p](const PathWheelConfig& w) { return w.source == p.name; });
  const auto bindings = pendant_layout(*device, p).bindings;
  if (!drives && std::any_of(bindings.begin(), bindings.end(), [](const pendant::Binding& b) {
        return b.action == pendant::Action::path_wheel;
      }))
    reading.error(m.where(path + ".buttons"), finding::kPathWheelButton, {p.name});
}

}  // namespace

void check_path_wheels(const LoadResult& loaded, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  for (std::size_t n = 0; n < m.path_wheels.size(); ++n) {
    const PathWheelConfig& w = m.path_wheels[n];
    const std::string path = "path_wheel." + std::to_string(n);
    if (w.process > m.control.processes)
      reading.error(m.where(path + ".process"), finding::kPathWheelProcess,
                    {std::to_string(w.process), std::to_string(m.control.processes)});
    for (std::size_t o = 0; o < n; ++o) {
      if (m.path_wheels[o].process == w.process)
        reading.error(m.where(path + ".process"), finding::kPathWheelTwice, {std::to_string(w.process)});
      else if (m.path_wheels[o].source == w.source)
        reading.error(m.where(path + ".source"), finding::kPathWheelShared, {w.source});
    }
    source_of(loaded, w, path, reading);
  }
  for (std::size_t n = 0; n < m.pendants.size(); ++n)
    buttons_of(loaded, m.pendants[n], "pendant." + std::to_string(n), reading);
}

}  // namespace servogate::machine
