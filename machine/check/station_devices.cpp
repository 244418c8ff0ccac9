// SPDX-License-Identifier: Apache-2.0
// Stations against their device files: channels, lines of a chip, bits of a drive.
#include <algorithm>

#include "machine/check/boot_objects.hpp"
#include "machine/check/check.hpp"
#include "machine/check/device_kind.hpp"
#include "machine/check/findings.hpp"

namespace servogate::machine {

namespace {

class StationDevices {
 public:
  StationDevices(const LoadResult& loaded, Reading& reading)
      : loaded_(loaded), m_(loaded.machine), reading_(reading) {}

  void stations() {
    for (std::size_t s = 0; s < m_.stations.size(); ++s) {
      const StationConfig& station = m_.stations[s];
      const std::string path = "station." + std::to_string(s);
      const DeviceConfig* device = loaded_.device(station.device);
      const DeviceKind wanted =
          station.kind == StationKind::modbus ? DeviceKind::modbus_io : DeviceKind::gpio;
      const bool inverter =
          station.kind == StationKind::modbus && device != nullptr && device->kind == DeviceKind::inverter;
      if (!inverter && device != nullptr && kind_known(*device) && device->kind != wanted) {
        reading_.error(m_.where(path + ".device"), finding::kWrongDevice,
                       {station.device, kind_name(device->kind),
                        kind_name(wanted) + (station.kind == StationKind::modbus ? ", inverter" : "")});
        continue;
      }
      if (station.kind == StationKind::canopen) continue;  // check_can_stations
      for (std::size_t p = 0; p < station.points.size(); ++p)
        channel(station, device, station.points[p], path + ".points." + std::to_string(p) + ".channel");
      if (station.kind == StationKind::drive) drive_points(station, path);
    }
  }

 private:
  /// How many channels of a kind a station has, numbered from 0; -1: that is not known.
  static int channels(const StationConfig& station, const DeviceConfig* device, ChannelKind kind) {
    if (station.kind == StationKind::board)
      return kind == ChannelKind::di || kind == ChannelKind::dq ? 32 : 4;
    if (station.kind == StationKind::drive) return 32;  // 60FDh and 60FEh have 32 bits
    const bool readable = device != nullptr && kind_known(*device);
    if (!station.device.empty() && !readable) return -1;
    if (station.kind == StationKind::gpio) return readable ? device->gpio.lines : GpioConfig{}.lines;
    if (!readable) return -1;
    const ModbusMap& map = device->modbus;
    const int counts[] = {map.di_count, map.dq_count, map.ai_count, map.aq_count};
    return counts[static_cast<std::size_t>(kind)];
  }

  void channel(const StationConfig& station, const DeviceConfig* device, const PointConfig& point,
               const std::string& path) {
    const bool no_analog = station.kind != StationKind::modbus && station.kind != StationKind::board &&
                           point.is_analog() && !point.is_encoder();  // said elsewhere
    const int count = channels(station, device, point.channel);
    if (no_analog || count < 0 || std::max(point.number, point.b_line) < count) return;
    const std::string kind = point.channel_text.substr(0, 2);
    const std::string last = kind + std::to_string(count - 1);
    const std::string what = count == 0   ? text::both("no " + kind, "ни одного " + kind)
                             : count == 1 ? text::both(last + " only", "только " + last)
                                          : text::both(kind + "0 to " + last, kind + "0 ... " + last);
    const std::string who = !station.node.empty()     ? station.node
                            : !station.device.empty() ? station.device
                            : station.kind == StationKind::board
                                ? text::both("a board", "плата")
                                : text::both("a chip without device file", "микросхема без файла устройства");
    reading_.error(m_.where(path), finding::kChannelOutside, {point.channel_text, who, what});
  }

  bool drives_something(const std::string& node) const {
    const auto same = [&](const auto& part) { return part.drive == node; };
    return std::any_of(m_.axes.begin(), m_.axes.end(), same) ||
           std::any_of(m_.spindles.begin(), m_.spindles.end(), same);
  }

  /// The bits of a drive have to be in its process data.
  void drive_points(const StationConfig& station, const std::string& path) {
    static constexpr int kFirstReserved = 4, kFirstOfMaker = 16;
    const NodeConfig* node = m_.node(station.node);
    if (node == nullptr) return;
    const DeviceConfig* device = loaded_.device(node->device);
    if (device != nullptr && device->terminals()) return;  // said by drives()
    if (!drives_something(station.node))
      return reading_.error(m_.where(path + ".node"), finding::kPointNoAxis, {station.node});
    if (device == nullptr || !kind_known(*device)) return;
    const auto mapped = [](const std::vector<PdoConfig>& pdos, int index, int sub) {
      for (const PdoConfig& pdo : pdos)
        for (const PdoObject& o : pdo.objects)
          if (o.index == index && o.subindex == sub) return true;
      return false;
    };
    for (std::size_t i = 0; i < station.points.size(); ++i) {
      const PointConfig& p = station.points[i];
      const Where at = m_.where(path + ".points." + std::to_string(i) + ".channel");
      if (p.number < 0 || p.is_analog()) continue;
      if (p.is_input() && p.number >= kFirstReserved && p.number < kFirstOfMaker)
        reading_.error(at, finding::kReservedChannel, {p.channel_text});
      if (p.is_input() && !mapped(device->tpdos, 0x60FD, 0))
        reading_.error(at, finding::kPointNotMapped, {p.channel_text, "60FD:00/32", "tpdo", node->device});
      if (p.is_input()) continue;
      if (!mapped(device->rpdos, 0x60FE, 1))
        reading_.error(at, finding::kPointNotMapped, {p.channel_text, "60FE:01/32", "rpdo", node->device});
      if (device->behaviour.brake_bit == p.number)
        reading_.error(at, finding::kBrakeBit, {p.channel_text, std::to_string(p.number), node->device});
      for (const auto* objects : {&device->objects, &node->objects})
        for (const auto& [name, value] : *objects) {
          const auto object = parse_object(name);
          if (object && object->index == 0x60FE && object->subindex == 2 &&
              (static_cast<std::uint32_t>(value) >> p.number & 1) == 0)
            reading_.error(at, finding::kMaskedOutput,
                           {p.channel_text, std::to_string(p.number), node->device});
        }
    }
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  Reading& reading_;
};

}  // namespace

void check_station_devices(const LoadResult& loaded, Reading& reading) {
  StationDevices(loaded, reading).stations();
}

}  // namespace servogate::machine
