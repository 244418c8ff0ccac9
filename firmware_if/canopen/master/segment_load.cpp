// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/segment_load.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/master/pdo/pdo_watch.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::canopen {
namespace {

/// How often a PDO comes in a cycle, on average; one on event at most once a cycle.
double per_cycle(const PdoWanted& pdo, image::Nanoseconds cycle_ns, bool transmit) {
  if (pdo.cyclic()) return 1.0 / pdo.transmission_type;
  if (pdo.remote())
    return 1.0 / static_cast<double>(std::max<std::int64_t>(1, cycles_between(pdo, cycle_ns)));
  if (!transmit || pdo.inhibit_100us == 0) return 1.0;
  const double inhibit_ns = pdo.inhibit_100us * 100'000.0;
  return std::min(1.0, static_cast<double>(cycle_ns) / inhibit_ns);
}

/// SYNC, the PDOs and what asks for them.
bool of_sync(const FrameLoad& frame) {
  const Service service = classify(frame.id, false).service;
  return service == Service::sync || (service >= Service::tpdo1 && service <= Service::rpdo4);
}

class Sum {
 public:
  Sum(std::uint32_t bit_rate, image::Nanoseconds cycle_ns)
      : bits_per_cycle_(static_cast<double>(bit_rate) * static_cast<double>(cycle_ns) * 1e-9) {}
  void add(std::uint32_t id, NodeId node, std::string what, std::uint8_t bytes, double often,
           bool every_sync = false) {
    const std::uint32_t bits = image::worst_case_bits(bytes);
    total_.frames.push_back({id, node, std::move(what), bytes, bits, often, every_sync});
    total_.load += bits * often / bits_per_cycle_;
    const double worst = bits * std::max(often, 1.0) / bits_per_cycle_;
    total_.worst_cycle += worst;
    if (of_sync(total_.frames.back())) total_.worst_process_data += worst;
  }
  void add_service_data(const SegmentServices& services) {
    const double free = bits_per_cycle_ * (1.0 - services.sdo_reserve - total_.load);
    const double share = sdo_share(free, kExchangeBits * services.sdo_frames_per_cycle);
    total_.worst_service_data = std::max(share, kExchangeBits) / bits_per_cycle_;
  }
  SegmentLoad take() {
    std::ranges::stable_sort(total_.frames, {}, &FrameLoad::id);
    return std::move(total_);
  }

 private:
  double bits_per_cycle_;
  SegmentLoad total_;
};

image::Nanoseconds next_cycle_of_series(image::Nanoseconds cycle_ns) {
  image::Nanoseconds step = image::kMillisecond / 4;
  while (step < cycle_ns) step *= 2;
  return step;
}

double load_of_part(std::uint32_t bit_rate, image::Nanoseconds cycle_ns, std::span<const NodeConfig> nodes,
                    std::size_t part, std::size_t parts, const SegmentServices& services) {
  std::vector<NodeConfig> mine;
  for (std::size_t i = part; i < nodes.size(); i += parts) mine.push_back(nodes[i]);
  return segment_load(bit_rate, cycle_ns, mine, services).load;
}

int segments_that_fit(std::uint32_t bit_rate, image::Nanoseconds cycle_ns, std::span<const NodeConfig> nodes,
                      const SegmentServices& services) {
  for (std::size_t parts = 1; parts <= nodes.size(); ++parts) {
    bool fits = true;
    for (std::size_t part = 0; part < parts && fits; ++part)
      fits = load_of_part(bit_rate, cycle_ns, nodes, part, parts, services) <= kLoadWarning;
    if (fits) return static_cast<int>(parts);
  }
  return 0;
}

/// Every cycle only the set-point and the actual position; all else rides in a second PDO every 10th SYNC.
NodeConfig with_four_byte_pdo(NodeConfig node) {
  if (node.target == DriveTarget::io) return node;
  const bool velocity = node.target == DriveTarget::spindle;
  PdoWanted target, actual, rest_out, rest_in;
  target.mapping.add({velocity ? object::kTargetVelocity : object::kTargetPosition, 0, 32});
  actual.mapping.add({object::kPositionActual, 0, 32});
  rest_out.mapping.add({object::kControlword, 0, 16});
  rest_in.mapping.add({object::kStatusword, 0, 16});
  rest_out.transmission_type = rest_in.transmission_type = 10;
  node.profile.rpdo = {target, rest_out};
  node.profile.tpdo = {actual, rest_in};
  return node;
}

constexpr text::Entry kTooFull{"can-load-error", "CAN segment {0}: load {1} % is above {2} %; it fits {3}{4}",
                               "сегмент CAN {0}: загрузка {1} % выше {2} %; поместится {3}{4}"};
constexpr text::Entry kNearlyFull{
    "can-load-warning",
    "CAN segment {0}: load {1} % is above {2} %, little is left for service data; more is left {3}{4}",
    "сегмент CAN {0}: загрузка {1} % выше {2} %, для сервисных данных остаётся мало; больше останется "
    "{3}{4}"};

}  // namespace

SegmentServices services_of(const SegmentConfig& config) noexcept {
  return {config.heartbeat_ms, config.sync_counter_overflow != 0, config.time_ms, config.sdo_frames_per_cycle,
          config.sdo_reserve};
}

SegmentLoad segment_load(std::uint32_t bit_rate, image::Nanoseconds cycle_ns,
                         std::span<const NodeConfig> nodes, const SegmentServices& services) {
  Sum sum(bit_rate, cycle_ns);
  const auto every = [cycle_ns](std::int32_t ms) { return static_cast<double>(cycle_ns) / (ms * 1e6); };
  sum.add(cob::kSync, 0, "SYNC", services.sync_counter ? 1 : 0, 1.0);
  if (services.time_ms > 0) sum.add(cob::kTime, 0, "TIME", 6, every(services.time_ms));
  sum.add(cob::heartbeat(0), 0, "heartbeat", 1, every(services.heartbeat_ms));
  for (const NodeConfig& node : nodes) {
    for (int n = 1; n <= 4; ++n) {
      const auto i = static_cast<std::size_t>(n - 1);
      const PdoWanted &rpdo = node.profile.rpdo[i], &tpdo = node.profile.tpdo[i];
      if (rpdo.used())
        sum.add(cob::rpdo(n, node.node), node.node, "RPDO" + std::to_string(n), rpdo.mapping.bytes(),
                per_cycle(rpdo, cycle_ns, false), rpdo.transmission_type == 1);
      if (tpdo.used() && tpdo.remote())
        sum.add(cob::tpdo(n, node.node), node.node, "request of TPDO" + std::to_string(n), 0,
                per_cycle(tpdo, cycle_ns, true));
      if (tpdo.used())
        sum.add(cob::tpdo(n, node.node), node.node, "TPDO" + std::to_string(n), tpdo.mapping.bytes(),
                per_cycle(tpdo, cycle_ns, true), tpdo.transmission_type == 1);
    }
    if (const std::int32_t guard_ms = node.profile.guard_time_ms; guard_ms > 0) {
      // A remote frame has the length of one without data. Source: CiA 301, "Node guarding".
      sum.add(cob::heartbeat(node.node), node.node, "guard request", 0, every(guard_ms));
      sum.add(cob::heartbeat(node.node), node.node, "guard answer", 1, every(guard_ms));
    } else {
      sum.add(cob::heartbeat(node.node), node.node, "heartbeat", 1,
              every(node.heartbeat_ms > 0 ? node.heartbeat_ms : services.heartbeat_ms));
    }
  }
  sum.add_service_data(services);
  return sum.take();
}

std::vector<const FrameLoad*> late_pdos(const SegmentLoad& load, std::uint32_t bit_rate,
                                        image::Nanoseconds cycle_ns) {
  std::vector<const FrameLoad*> late;
  double free = static_cast<double>(bit_rate) * static_cast<double>(cycle_ns) * 1e-9;
  // The frames are in the order of their urgency.
  for (const FrameLoad& frame : load.frames) {
    if (!of_sync(frame)) continue;
    free -= frame.bits;
    if (free < 0.0 && frame.every_sync) late.push_back(&frame);
  }
  return late;
}

LoadAdvice advise(std::uint32_t bit_rate, image::Nanoseconds cycle_ns, std::span<const NodeConfig> nodes,
                  const SegmentServices& services) {
  LoadAdvice advice;
  advice.cycle_ns = next_cycle_of_series(cycle_ns);
  while (advice.cycle_ns < image::kSecond &&
         segment_load(bit_rate, advice.cycle_ns, nodes, services).load > kLoadWarning)
    advice.cycle_ns *= 2;
  advice.segments = segments_that_fit(bit_rate, cycle_ns, nodes, services);
  std::vector<NodeConfig> small;
  for (const NodeConfig& node : nodes) small.push_back(with_four_byte_pdo(node));
  advice.load_with_4_byte_pdo = segment_load(bit_rate, cycle_ns, small, services).load;
  return advice;
}

const text::Entry* load_text(double load) noexcept {
  if (load > kLoadError) return &kTooFull;
  return load > kLoadWarning ? &kNearlyFull : nullptr;
}

}  // namespace servogate::canopen
