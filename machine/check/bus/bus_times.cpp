// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/consequences.hpp"
#include "machine/keys/units.hpp"

namespace servogate::machine {

namespace {

/// Times that a bus, its nodes and the cycle cannot keep together.
class BusTimes {
 public:
  BusTimes(const LoadResult& loaded, std::size_t index, Reading& reading)
      : loaded_(loaded),
        m_(loaded.machine),
        bus_(m_.buses[index]),
        path_("bus." + std::to_string(index)),
        cycle_(static_cast<double>(m_.cycle_ns()) * 1e-9),
        reading_(reading) {}

  void all() {
    window();
    const double shortest = std::max(cycle_, 0.001);  // the master counts milliseconds
    if (bus_.time_period > 0.0 && bus_.time_period < shortest * kBelow)
      reading_.error(m_.where(path_ + ".time_period"), finding::kTimeShort,
                     {milliseconds(bus_.time_period), bus_.name, milliseconds(shortest)});
    for (std::size_t n = 0; n < bus_.nodes.size(); ++n)
      node(bus_.nodes[n], path_ + ".node." + std::to_string(n));
  }

 private:
  static constexpr double kBelow = 1.0 - 1e-9, kAbove = 1.0 + 1e-9;

  /// 1007h counts from SYNC (CiA 301, 7.5.2.8).
  void window() {
    if (bus_.sync_window <= 0.0) return;
    const Where where = m_.where(path_ + ".sync_window");
    if (bus_.sync_window > cycle_ * kAbove)
      return reading_.error(where, finding::kWindowLong,
                            {milliseconds(bus_.sync_window), bus_.name, milliseconds(cycle_)});
    if (bus_.bit_rate <= 0 || bus_.nodes.empty()) return;
    const double needed = segment_load(loaded_, bus_).worst_process_data * cycle_;
    if (bus_.sync_window < needed)
      reading_.error(where, finding::kWindowShort,
                     {milliseconds(bus_.sync_window), bus_.name, milliseconds(needed)});
  }

  void node(const NodeConfig& node, const std::string& path) {
    const double patience =
        node.boot_timeout > 0.0 ? node.boot_timeout : canopen::SegmentConfig().boot_timeout_ms * 1e-3;
    const DeviceConfig* device = loaded_.device(node.device);
    const double guard = device != nullptr && device->drive() ? device->behaviour.guard_time : 0.0;
    if (guard > 0.0) {
      guarding(node, path, guard, patience);
    } else {
      if (node.heartbeat < cycle_ * kBelow)
        reading_.error(m_.where(path + ".heartbeat"), finding::kHeartbeatShort,
                       {milliseconds(node.heartbeat), node.name, milliseconds(cycle_)});
      if (node.heartbeat >= patience)
        reading_.error(m_.where(path + ".heartbeat"), finding::kHeartbeatLong,
                       {milliseconds(node.heartbeat), node.name, milliseconds(patience)});
    }
    if (device != nullptr) deadlines(node, path, *device);
  }

  void guarding(const NodeConfig& node, const std::string& path, double guard, double patience) {
    if (guard < std::max(cycle_, 0.001) * kBelow)
      reading_.error(m_.where(path + ".device"), finding::kGuardShort,
                     {node.name, milliseconds(guard), node.device, milliseconds(cycle_)});
    if (guard >= patience)
      reading_.error(m_.where(path + (node.boot_timeout > 0.0 ? ".boot_timeout" : ".device")),
                     finding::kGuardLong, {milliseconds(patience), node.name, milliseconds(guard)});
  }

  /// A deadline must let the next frame come.
  void deadlines(const NodeConfig& node, const std::string& path, const DeviceConfig& device) {
    for (const PdoConfig& pdo : device.rpdos) {
      const double period = cycle_ * (pdo.cyclic() ? pdo.transmission : 1);
      if (pdo.event > 0.0 && !pdo.remote() && pdo.event <= period * kAbove)
        reading_.error(m_.where(path + ".device"), finding::kDeadlineShort,
                       {node.name, std::to_string(pdo.number), node.device, milliseconds(pdo.event),
                        milliseconds(period)});
    }
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  const BusConfig& bus_;
  std::string path_;
  double cycle_;  ///< s
  Reading& reading_;
};

}  // namespace

void check_bus_times(const LoadResult& loaded, Reading& reading) {
  for (std::size_t b = 0; b < loaded.machine.buses.size(); ++b) BusTimes(loaded, b, reading).all();
}

}  // namespace servogate::machine
