// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "firmware_if/canopen/master/bus_node.hpp"
#include "firmware_if/canopen/master/segment_load.hpp"

namespace servogate::canopen {

/// What service data may take of the bus: what the planned load of the nodes that run, and a reserve, leave.
/// A bucket that holds a cycle's share, one exchange at least.
class SdoBudget {
 public:
  SdoBudget(const SegmentConfig& config, std::uint32_t bit_rate);
  /// A cycle begins. real-time safe.
  void refill(std::span<const BusNode> nodes) noexcept;
  bool enough() const noexcept { return bits_ >= kExchangeBits; }
  void take() noexcept { bits_ -= kExchangeBits; }
  /// Exchanges of a cycle with all nodes running, on average. real-time safe.
  double exchanges_per_cycle() const noexcept;

 private:
  double share(double free) const noexcept;

  double cycle_bits_, most_;
  double free_ = 0.0;              ///< bits of a cycle without any node
  std::vector<double> node_bits_;  ///< of a cycle, by node
  double bits_ = 0.0;
};

/// How a node that only answers SDO is served at best: time from one set-point, with its actual value and its
/// statusword, to the next, while all such nodes of the segment want their turns and answer within a cycle. 0
/// where the node has process data. Not real-time safe.
image::Nanoseconds sdo_round_ns(const SegmentConfig& segment, const NodeConfig& node, std::uint32_t bit_rate);

}  // namespace servogate::canopen
