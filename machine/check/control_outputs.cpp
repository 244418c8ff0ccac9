// SPDX-License-Identifier: Apache-2.0
#include "machine/check/check.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

/// A point of the file by its name, with its path.
PointConfig* find_point(MachineConfig& machine, const std::string& name, std::string& path) {
  for (std::size_t s = 0; s < machine.stations.size(); ++s)
    for (std::size_t p = 0; p < machine.stations[s].points.size(); ++p)
      if (machine.stations[s].points[p].name == name) {
        path = "station." + std::to_string(s) + ".points." + std::to_string(p);
        return &machine.stations[s].points[p];
      }
  return nullptr;
}

}  // namespace

void claim_control_outputs(MachineConfig& machine, Reading& reading) {
  std::map<std::string, std::string> owners;
  const auto claim = [&](const std::string& name, const std::string& path, const std::string& shown) {
    std::string where;
    PointConfig* point = name.empty() ? nullptr : find_point(machine, name, where);
    if (point == nullptr || point->is_input()) return;  // said by the references
    const auto [owner, fresh] = owners.try_emplace(name, shown);
    if (!fresh)
      reading.error(machine.where(path), finding::kControlWritesTwice, {shown, name, owner->second});
    if (machine.places.contains(where + ".writer") && point->writer != image::Writer::nc)
      reading.error(
          machine.where(where + ".writer"), finding::kControlWrites,
          {shown, name, std::string(choices_of<image::Writer>()[static_cast<std::size_t>(point->writer)])});
    point->writer = image::Writer::nc;
  };
  claim(machine.safety.control_alive, "safety.control_alive", "safety.control_alive");
  for (std::size_t i = 0; i < machine.axes.size(); ++i)
    claim(machine.axes[i].brake.point, "axis." + std::to_string(i) + ".brake.point", "axis.brake.point");
  for (std::size_t i = 0; i < machine.spindles.size(); ++i) {
    const SpindleConfig& s = machine.spindles[i];
    const std::string path = "spindle." + std::to_string(i);
    claim(s.speed_output, path + ".speed_output", "spindle.speed_output");
    claim(s.cw_output, path + ".cw_output", "spindle.cw_output");
    claim(s.ccw_output, path + ".ccw_output", "spindle.ccw_output");
    for (std::size_t g = 0; g < s.gears.size(); ++g)
      claim(s.gears[g].output, path + ".gears." + std::to_string(g) + ".output", "spindle.gears.output");
  }
}

}  // namespace servogate::machine
