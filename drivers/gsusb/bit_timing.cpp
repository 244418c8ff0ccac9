// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/bit_timing.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::gsusb {
namespace {

/// What two crystals of 0.05 % may differ by, and still well inside what re-synchronisation bears.
constexpr double kRateTolerance = 0.001;

/// Splits a bit of `quanta` quanta so that it is read near `sample_point`.
std::optional<BitTiming> split(const TimingLimits& l, std::uint32_t quanta, std::uint32_t prescaler,
                               double sample_point) noexcept {
  if (quanta < 1 + l.segment_1_min + l.segment_2_min || quanta > 1 + l.segment_1_max + l.segment_2_max)
    return std::nullopt;
  const std::uint32_t rest = quanta - 1;
  const auto wanted = static_cast<std::uint32_t>(std::lround(quanta * (1.0 - sample_point)));
  const std::uint32_t least = rest > l.segment_1_max ? rest - l.segment_1_max : 0;
  const std::uint32_t most = rest > l.segment_1_min ? rest - l.segment_1_min : 0;
  const std::uint32_t low = std::max({least, l.segment_2_min, 1u}), high = std::min(most, l.segment_2_max);
  if (low > high) return std::nullopt;
  BitTiming t;
  t.phase_2 = std::clamp(wanted, low, high);
  const std::uint32_t segment_1 = rest - t.phase_2;
  t.phase_1 = std::max(segment_1 / 2, segment_1 > 0 ? 1u : 0u);
  t.propagation = segment_1 - t.phase_1;
  t.jump_width = std::clamp(std::min(t.phase_1, t.phase_2 / 2), 1u, std::max(l.jump_width_max, 1u));
  t.prescaler = prescaler;
  return t;
}

}  // namespace

double recommended_sample_point(std::uint32_t bit_rate) noexcept {
  return bit_rate > 800'000 ? 0.75 : bit_rate > 500'000 ? 0.80 : 0.875;
}

std::optional<BitTiming> find_timing(const TimingLimits& l, std::uint32_t bit_rate) noexcept {
  if (bit_rate == 0 || l.clock_hz == 0) return std::nullopt;
  const double point = recommended_sample_point(bit_rate);
  std::optional<BitTiming> best;
  double best_rate = kRateTolerance, best_point = 1.0;
  const std::uint32_t step = std::max(l.prescaler_step, 1u);
  // Ascending prescalers: of equals the first has the most quanta.
  for (std::uint64_t p = std::max(l.prescaler_min, 1u); p <= l.prescaler_max; p += step) {
    const auto prescaler = static_cast<std::uint32_t>(p);
    const double exact = static_cast<double>(l.clock_hz) / (static_cast<double>(bit_rate) * prescaler);
    if (exact < 3.0) break;
    if (exact > 1.0 + l.segment_1_max + l.segment_2_max + 0.5) continue;
    const auto t = split(l, static_cast<std::uint32_t>(std::lround(exact)), prescaler, point);
    if (!t) continue;
    const double rate_off = std::abs(t->bit_rate(l.clock_hz) / bit_rate - 1.0);
    const double point_off = std::abs(t->sample_point() - point);
    const bool better =
        rate_off < best_rate - 1e-9 || (rate_off < best_rate + 1e-9 && point_off < best_point - 1e-9);
    if (rate_off > kRateTolerance || (best && !better)) continue;
    best = t;
    best_rate = rate_off;
    best_point = point_off;
  }
  return best;
}

}  // namespace servogate::gsusb
