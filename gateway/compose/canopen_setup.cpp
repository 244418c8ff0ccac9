// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/canopen_setup.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::gateway {

canopen::SegmentConfig segment_config(const machine::LoadResult& loaded, int index) {
  const machine::MachineConfig& m = loaded.machine;
  const machine::BusConfig& bus = m.buses[static_cast<std::size_t>(index)];
  canopen::SegmentConfig c;
  c.index = index;
  c.name = bus.name;
  c.cycle_ns = m.cycle_ns();
  if (bus.sync_counter) c.sync_counter_overflow = 240;
  c.sync_window_us = static_cast<std::int32_t>(std::lround(bus.sync_window * 1e6));
  c.time_ms = static_cast<std::int32_t>(std::lround(bus.time_period * 1e3));
  for (const machine::NodeConfig& node : bus.nodes) {
    canopen::NodeConfig n;
    n.node = static_cast<canopen::NodeId>(node.id);
    n.name = node.name;
    const std::string reference = bus.name + "." + node.name;
    std::int64_t counts = 0;
    bool used = false;
    for (std::size_t a = 0; a < m.axes.size(); ++a)
      if (m.axes[a].drive == reference) {
        n.target = canopen::DriveTarget::axis;
        n.target_index = static_cast<int>(a);
        counts = m.axes[a].counts_per_rev;
        used = true;
      }
    for (std::size_t s = 0; s < m.spindles.size(); ++s)
      if (m.spindles[s].drive == reference) {
        n.target = canopen::DriveTarget::spindle;
        n.target_index = static_cast<int>(s);
        counts = m.spindles[s].counts_per_rev;
        used = true;
      }
    if (!used) continue;
    if (const machine::DeviceConfig* device = loaded.device(node.device); device != nullptr)
      n.profile = machine::drive_profile(*device, node, counts);
    n.heartbeat_ms = static_cast<std::int32_t>(std::lround(node.heartbeat * 1e3));
    n.max_missed_pdo = static_cast<std::int32_t>(node.loss_cycles);
    n.unsupervised = node.unsupervised;
    n.setup.software_version = node.software_version;
    n.setup.boot_timeout_ms = static_cast<std::int32_t>(std::lround(node.boot_timeout * 1e3));
    n.setup.boot_attempts = node.boot_attempts;
    // The control's own heartbeat is as quick as the quickest node's.
    if (n.heartbeat_ms > 0) c.heartbeat_ms = std::min(c.heartbeat_ms, n.heartbeat_ms);
    c.nodes.push_back(std::move(n));
  }
  c.heartbeat_timeout_ms = 3 * c.heartbeat_ms;
  return c;
}

}  // namespace servogate::gateway
