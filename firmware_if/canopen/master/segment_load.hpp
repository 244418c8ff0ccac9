// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/image/frames/can_wire.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// One frame of the plan.
struct FrameLoad {
  std::uint32_t id = 0;
  NodeId node = 0;   ///< 0: SYNC, TIME and the control's heartbeat
  std::string what;  ///< "SYNC", "RPDO1", "TPDO2", "heartbeat", "guard request", "guard answer", "TIME"
  std::uint8_t bytes = 0;
  std::uint32_t bits = 0;   ///< worst case with stuff bits and interframe space
  double per_cycle = 0.0;   ///< how often in a cycle, on average
  bool every_sync = false;  ///< a PDO of transmission type 1
};

/// Planned load of a segment, from the real mapping. 1.0 = the bus is full.
struct SegmentLoad {
  double load = 0.0;  ///< mean over time; what the limits of kLoadWarning and kLoadError apply to
  double worst_cycle =
      0.0;  ///< when everything falls into one cycle; above 1 the least urgent frames are a cycle late
  double worst_process_data = 0.0;  ///< of it SYNC and the PDOs, all of one SYNC
  double worst_service_data = 0.0;  ///< what SDO takes of such a cycle, beside it
  std::vector<FrameLoad> frames;
};

/// The PDOs of every SYNC that do not fit into its cycle when all slower and event-driven ones come, too, the
/// most urgent first; empty: all do. Not real-time safe.
std::vector<const FrameLoad*> late_pdos(const SegmentLoad& load, std::uint32_t bit_rate,
                                        image::Nanoseconds cycle_ns);

inline constexpr double kLoadWarning = 0.80;
inline constexpr double kLoadError = 0.90;

/// What the control sends beside process data.
struct SegmentServices {
  std::int32_t heartbeat_ms = 100;  ///< of the control, and of every node that has no time of its own
  bool sync_counter = false;        ///< SYNC carries its counter byte
  std::int32_t time_ms = 0;         ///< period of the TIME message, 0: none
  std::int32_t sdo_frames_per_cycle = 4;
  double sdo_reserve = 0.05;
};
/// Request and answer of a service data transfer, bits on the wire.
inline constexpr double kExchangeBits = 2.0 * image::worst_case_bits(8);
/// However full the bus is planned, one exchange in so many cycles goes through.
inline constexpr double kCyclesPerExchange = 20.0;
/// Bits of a cycle that service data may take where `free` are left by the rest. real-time safe.
constexpr double sdo_share(double free, double most) noexcept {
  const double least = std::min(kExchangeBits / kCyclesPerExchange, most);
  return std::clamp(free, least, most);
}

/// Of a configured segment.
SegmentServices services_of(const SegmentConfig& config) noexcept;

/// Load of the cyclic traffic: SYNC, PDOs, heartbeats, requests and answers of node guarding, TIME; SDO uses
/// what is left. bit_rate in bit/s. Not real-time safe.
SegmentLoad segment_load(std::uint32_t bit_rate, image::Nanoseconds cycle_ns,
                         std::span<const NodeConfig> nodes, const SegmentServices& services = {});

/// What would bring the load to at most kLoadWarning.
struct LoadAdvice {
  image::Nanoseconds cycle_ns = 0;  ///< shortest cycle of the series 0.25 0.5 1 2 4 8 ... ms that fits
  int segments =
      1;  ///< number of segments of the same bit rate that fit, nodes shared evenly; 0: no number does
  double load_with_4_byte_pdo =
      0.0;  ///< with 607Ah alone and 6064h alone every cycle, the rest every 10th SYNC
};
LoadAdvice advise(std::uint32_t bit_rate, image::Nanoseconds cycle_ns, std::span<const NodeConfig> nodes,
                  const SegmentServices& services = {});

/// Sentence for the machine file's check: {0} segment, {1} load in per cent, {2} limit, {3} with what it fits
/// ("with a cycle of 2 ms"), {4} what else would help. nullptr when the load is fine. Severity: error above
/// kLoadError, otherwise warning.
const text::Entry* load_text(double load) noexcept;

}  // namespace servogate::canopen
