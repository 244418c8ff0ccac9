// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/sdo_budget.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::canopen {
namespace {

/// Statusword, actual value, target and controlword; with the set-point handshake of pp the controlword twice
/// and the statusword twice more.
constexpr double kExchangesOfRound = 4.0, kExchangesOfHandshake = 7.0;

}  // namespace

SdoBudget::SdoBudget(const SegmentConfig& config, std::uint32_t bit_rate)
    : cycle_bits_(static_cast<double>(bit_rate) * static_cast<double>(config.cycle_ns) * 1e-9),
      most_(kExchangeBits * config.sdo_frames_per_cycle) {
  const auto bits = [&](std::span<const NodeConfig> nodes) {
    return cycle_bits_ <= 0.0
               ? 0.0
               : cycle_bits_ * segment_load(bit_rate, config.cycle_ns, nodes, services_of(config)).load;
  };
  const double own = bits({});
  free_ = cycle_bits_ * (1.0 - config.sdo_reserve) - own;
  for (const NodeConfig& node : config.nodes) node_bits_.push_back(bits({&node, 1}) - own);
}

// An unknown bit rate is no limit.
double SdoBudget::share(double free) const noexcept {
  return cycle_bits_ <= 0.0 ? most_ : sdo_share(free, most_);
}

void SdoBudget::refill(std::span<const BusNode> nodes) noexcept {
  double free = free_;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].online()) free -= node_bits_[i];
  const double mine = share(free);
  bits_ = std::min(bits_ + mine, std::max(mine, kExchangeBits));
}

double SdoBudget::exchanges_per_cycle() const noexcept {
  double free = free_;
  for (const double bits : node_bits_) free -= bits;
  return share(free) / kExchangeBits;
}

image::Nanoseconds sdo_round_ns(const SegmentConfig& segment, const NodeConfig& node,
                                std::uint32_t bit_rate) {
  if (!node.profile.sdo_only) return 0;
  const auto sharing =
      std::ranges::count_if(segment.nodes, [](const NodeConfig& other) { return other.profile.sdo_only; });
  const double of_this = SdoBudget(segment, bit_rate).exchanges_per_cycle() /
                         static_cast<double>(std::max<std::ptrdiff_t>(1, sharing));
  const bool handshake = node.target == DriveTarget::axis;
  const double exchanges = handshake ? kExchangesOfHandshake : kExchangesOfRound;
  // A node has one transfer under way at a time, and its answer is read in the next cycle.
  const double cycles = exchanges / std::min(1.0, of_this);
  return std::llround(std::ceil(cycles)) * segment.cycle_ns;
}

}  // namespace servogate::canopen
