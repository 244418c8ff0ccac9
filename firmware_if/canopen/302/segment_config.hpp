// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/time_of_day.hpp"
#include "firmware_if/canopen/302/io_station.hpp"
#include "firmware_if/canopen/302/node_setup.hpp"
#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Which part of the process image a node supplies; io: points of packet A.
enum class DriveTarget : std::uint8_t { axis, spindle, io };

/// One drive or I/O module on the segment.
struct NodeConfig {
  NodeId node = 1;
  std::string name;  ///< as the machine file calls it, for messages
  DriveProfile profile;
  DriveTarget target = DriveTarget::axis;
  int target_index = 0;           ///< index in ProcessImage::axes, ::spindles or ::sources
  IoStation io;                   ///< target io: its points
  std::int32_t heartbeat_ms = 0;  ///< producer time of this node, lost after three of them; 0: the segment's
  std::int32_t max_missed_pdo = 0;  ///< 0: the segment's
  /// It may run although it would not notice the death of the control (see stops_by_itself(),
  /// notices_silence()).
  bool unsupervised = false;
  /// What its loss makes the machine do: stop_on_path or something stronger.
  image::Reaction loss_reaction = image::Reaction::stop_on_path;
  NodeSetup setup;  ///< version, program and configuration of this one node
};

/// One CAN bus and how it is run.
struct SegmentConfig {
  int index = 0;  ///< in ProcessImage::segments
  std::string name;
  NodeId own_node = 127;  ///< node-ID of the control, used for its heartbeat
  image::Nanoseconds cycle_ns = image::kMillisecond;
  std::vector<NodeConfig> nodes;

  std::int32_t heartbeat_ms = 100;          ///< producer time of every node and of the control
  std::int32_t heartbeat_timeout_ms = 300;  ///< consumer time on both sides
  std::int32_t max_missed_pdo = 3;          ///< process data missing in a row after which a node is offline
  /// SYNC counter runs from 1 to this and begins anew (1019h); 0: SYNC has no counter. 2-240. With a counter
  /// SYNC begins when it is written into all nodes that answer, and they are started then.
  std::uint8_t sync_counter_overflow = 0;
  std::int32_t sync_window_us = 0;  ///< 1007h of every node: later synchronous PDOs are dropped; 0: no window
  std::int32_t time_ms = 0;         ///< period of the TIME message; 0: none is sent
  TimeOfDay time_at_start;          ///< time of day at t = 0 of the machine's clock
  std::int32_t sdo_timeout_ms = 200;
  std::int32_t sdo_retries = 2;         ///< repetitions of a transfer after a time-out
  std::int32_t boot_timeout_ms = 2000;  ///< wait for the boot-up message and for Operational
  std::int32_t boot_attempts = 3;    ///< before boot_failed is said; the boot is tried on and on afterwards
  std::int32_t boot_pause_ms = 500;  ///< between two attempts
  std::int32_t sdo_frames_per_cycle = 4;  ///< bound of the acyclic frames sent in a cycle
  /// Share of the bus that service data leave free beside the planned load: without it they would starve what
  /// has lower priority than they have, the heartbeats.
  double sdo_reserve = 0.05;
};

/// Producer time of a node's heartbeat, ms. real-time safe.
constexpr std::int32_t heartbeat_ms(const NodeConfig& node, const SegmentConfig& segment) noexcept {
  return node.heartbeat_ms > 0 ? node.heartbeat_ms : segment.heartbeat_ms;
}
/// Silence after which a node is lost, ms. real-time safe.
constexpr std::int32_t heartbeat_timeout_ms(const NodeConfig& node, const SegmentConfig& segment) noexcept {
  if (node.profile.guard_time_ms > 0) return node.profile.guard_time_ms * node.profile.life_time_factor;
  return node.heartbeat_ms > 0 ? 3 * node.heartbeat_ms : segment.heartbeat_timeout_ms;
}
/// Wait for the answer to a service data request, ms; a node that only answers SDO is lost then. real-time
/// safe.
constexpr std::int32_t sdo_timeout_ms(const NodeConfig& node, const SegmentConfig& segment) noexcept {
  return node.setup.sdo_timeout_ms > 0 ? node.setup.sdo_timeout_ms : segment.sdo_timeout_ms;
}
/// Process data missing in a row after which a node is offline. real-time safe.
constexpr std::int32_t max_missed_pdo(const NodeConfig& node, const SegmentConfig& segment) noexcept {
  return node.max_missed_pdo > 0 ? node.max_missed_pdo : segment.max_missed_pdo;
}

}  // namespace servogate::canopen
