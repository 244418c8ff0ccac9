// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "machine/can_channel.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

std::string kind_name(DeviceKind kind) {
  return std::string(choices_of<DeviceKind>()[static_cast<std::size_t>(kind)]);
}

/// "6000:02/8", as a device file writes it.
std::string object_text(const PdoObject& o) {
  char text[24];
  std::snprintf(text, sizeof text, "%04X:%02X/%d", o.index, o.subindex, o.bits);
  return text;
}

class CanStation {
 public:
  CanStation(const LoadResult& loaded, std::size_t index, Reading& reading)
      : m_(loaded.machine),
        s_(m_.stations[index]),
        path_("station." + std::to_string(index)),
        reading_(reading),
        node_(m_.node(s_.node)),
        device_(node_ == nullptr ? nullptr : loaded.device(node_->device)) {}

  void all() {
    if (device_ == nullptr || !device_->places.contains("kind")) return;  // said elsewhere
    if (!device_->terminals())
      return reading_.error(m_.where(path_ + ".node"), finding::kWrongDevice,
                            {node_->device, kind_name(device_->kind), "canopen_io, canopen_encoder"});
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.points[i].number >= 0) point(s_.points[i], path_ + ".points." + std::to_string(i));
  }

 private:
  void point(const PointConfig& p, const std::string& path) {
    const auto found = channel_object(device_->kind, p.channel, p.number);
    if (!found)
      return reading_.error(m_.where(path + ".channel"), finding::kNoSuchChannel,
                            {p.channel_text, kind_name(device_->kind)});
    const PdoConfig* pdo = pdo_with(p.is_input() ? device_->tpdos : device_->rpdos, found->object);
    if (pdo == nullptr)
      return reading_.error(
          m_.where(path + ".channel"), finding::kPointNotMapped,
          {p.channel_text, object_text(found->object), p.is_input() ? "tpdo" : "rpdo", node_->device});
    if (p.is_analog()) number(p, *found, path);
    if (!p.is_input() && device_->behaviour.connection_loss == ConnectionLoss::none &&
        (p.hold || p.loss != 0.0))
      reading_.error(m_.where(path + (p.hold ? ".hold" : ".loss")), finding::kLossIsTheModules,
                     {p.name, node_->device});
    if (p.channel == ChannelKind::di && pdo->transmission != 1) slow(p, *pdo);
  }

  void number(const PointConfig& p, const ChannelObject& channel, const std::string& path) {
    if (p.scale == 0.0) reading_.error(m_.where(path + ".scale"), finding::kZeroScale, {p.name});
    if (channel.object.bits > 16 && p.place.format == image::Format::in)
      reading_.error(m_.where(path + ".place"), finding::kPointFormat,
                     {to_string(p.place), p.name, text::both("a value of 32 bits", "значение из 32 бит"),
                      text::both("a double word (SA16.LI)", "двойное слово (SA16.LI)")});
    if (!p.is_input() && (p.loss != std::nearbyint(p.loss) || p.loss < -32768.0 || p.loss > 32767.0))
      reading_.error(m_.where(path + ".loss"), finding::kLossRange,
                     {p.name, text::number(p.loss), "-32768 ... 32767"});
  }

  /// What stops the machine must not wait for its turn.
  void slow(const PointConfig& p, const PdoConfig& pdo) {
    const std::string number = std::to_string(pdo.number);
    if (m_.safety.estop == p.name)
      reading_.error(m_.where("safety.estop"), finding::kEstopSlow, {p.name, number, node_->device});
    for (std::size_t i = 0; i < m_.axes.size(); ++i)
      for (const auto& [key, name] : {std::pair(".limit_plus", m_.axes[i].limit_plus),
                                      std::pair(".limit_minus", m_.axes[i].limit_minus)})
        if (name == p.name)
          reading_.warning(m_.where("axis." + std::to_string(i) + key), finding::kLimitSlow,
                           {m_.axes[i].letter, p.name, number, node_->device});
  }

  const MachineConfig& m_;
  const StationConfig& s_;
  std::string path_;
  Reading& reading_;
  const NodeConfig* node_;
  const DeviceConfig* device_;
};

/// Every module has one station, and every station a module of its own.
void check_owners(const LoadResult& loaded, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  std::map<std::string, std::string> owners;
  for (std::size_t s = 0; s < m.stations.size(); ++s) {
    const StationConfig& station = m.stations[s];
    if (station.kind != StationKind::canopen || station.node.empty()) continue;
    const auto [it, fresh] = owners.try_emplace(station.node, station.name);
    if (!fresh)
      reading.error(m.where("station." + std::to_string(s) + ".node"), finding::kStationNodeTwice,
                    {station.node, it->second});
  }
  for (std::size_t b = 0; b < m.buses.size(); ++b)
    for (std::size_t n = 0; n < m.buses[b].nodes.size(); ++n) {
      const NodeConfig& node = m.buses[b].nodes[n];
      const DeviceConfig* device = loaded.device(node.device);
      const std::string name = m.buses[b].name + "." + node.name;
      const std::string path = "bus." + std::to_string(b) + ".node." + std::to_string(n);
      if (device == nullptr || !device->places.contains("kind") || !device->terminals()) continue;
      if (!owners.contains(name)) reading.warning(m.where(path + ".name"), finding::kNodeNoStation, {name});
      if (!device->rpdos.empty() && !node.unsupervised &&
          !canopen::notices_silence(drive_profile(*device, node, 0)))
        reading.error(m.where(path + ".device"), finding::kUnsupervisedModule, {node.name, node.device});
      if (device->behaviour.connection_loss == ConnectionLoss::none && !node.unsupervised)
        for (const PdoConfig& pdo : device->rpdos)
          if (pdo.event <= 0.0)
            reading.error(m.where(path + ".device"), finding::kNoErrorStates,
                          {node.name, node.device, std::to_string(pdo.number)});
    }
}

}  // namespace

void check_can_stations(const LoadResult& loaded, Reading& reading) {
  for (std::size_t s = 0; s < loaded.machine.stations.size(); ++s)
    if (loaded.machine.stations[s].kind == StationKind::canopen) CanStation(loaded, s, reading).all();
  check_owners(loaded, reading);
}

}  // namespace servogate::machine
