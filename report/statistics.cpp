// SPDX-License-Identifier: Apache-2.0
#include "report/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace servogate::report {

namespace {

// Below 64 ns each value has its own bucket; above, every doubling is cut into 64 equal ones.
constexpr int kStepBits = 6;
constexpr std::int64_t kSteps = std::int64_t{1} << kStepBits;
constexpr int kTopBits = 40;
constexpr std::int64_t kTop = std::int64_t{1} << kTopBits;
constexpr std::size_t kBuckets = static_cast<std::size_t>((kTopBits - kStepBits + 1) * kSteps + 1);

std::size_t bucket_of(std::int64_t ns) noexcept {
  if (ns < kSteps) return static_cast<std::size_t>(ns);
  const int octave = std::bit_width(static_cast<std::uint64_t>(ns)) - 1 - kStepBits;
  return static_cast<std::size_t>(octave * kSteps + (ns >> octave));
}

std::int64_t first_of(std::size_t bucket) noexcept {
  const auto b = static_cast<std::int64_t>(bucket);
  if (b < 2 * kSteps) return b;
  const std::int64_t octave = b / kSteps - 1;
  return (b - octave * kSteps) << octave;
}

}  // namespace

Histogram::Histogram() : counts_(kBuckets, 0) {}

void Histogram::add(std::int64_t ns) noexcept {
  ns = std::clamp<std::int64_t>(ns, 0, kTop);
  ++counts_[bucket_of(ns)];
  ++count_;
  max_ = std::max(max_, ns);
  sum_ += static_cast<double>(ns);
}

double Histogram::mean() const noexcept { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }

std::int64_t Histogram::quantile(double q) const noexcept {
  if (count_ == 0) return 0;
  if (q >= 1.0) return max_;
  const double wanted = std::max(1.0, std::ceil(std::max(q, 0.0) * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t b = 0; b < counts_.size(); ++b) {
    seen += counts_[b];
    if (static_cast<double>(seen) >= wanted) return std::min(first_of(b + 1) - 1, max_);
  }
  return max_;
}

std::vector<Histogram::Bucket> Histogram::buckets() const {
  std::vector<Bucket> out;
  for (std::size_t b = 0; b < counts_.size(); ++b)
    if (counts_[b] != 0) out.push_back({first_of(b), first_of(b + 1) - 1, counts_[b]});
  return out;
}

void AxisStatistics::add(std::int64_t cycle, double period_s, const TraceAxis& axis) noexcept {
  if (axis.enabled) max_error_ = std::max(max_error_, std::fabs(axis.following_error));
  const bool continues = known_ > 0 && axis.enabled && cycle == last_cycle_ + 1 && axis.homed == last_homed_;
  if (!continues) known_ = 0;
  derived_ = known_;
  std::array<double, 3> next{};
  double difference = axis.command - position_;
  for (int order = 0; order < 3 && order < known_; ++order) {
    const auto o = static_cast<std::size_t>(order);
    next[o] = difference / period_s;
    max_[o] = std::max(max_[o], std::fabs(next[o]));
    difference = next[o] - now_[o];
  }
  now_ = next;
  position_ = axis.command;
  last_cycle_ = cycle;
  last_homed_ = axis.homed;
  known_ = axis.enabled ? std::min(known_ + 1, 3) : 0;
}

RunStatistics::RunStatistics(const TraceLayout& layout)
    : period_s_(static_cast<double>(layout.period_ns) * 1e-9),
      axes_(std::min<std::size_t>(layout.axes.size(), image::kMaxAxes)) {}

void RunStatistics::add(const TraceRow& row) noexcept {
  ++cycles_;
  for (std::size_t a = 0; a < axes_.size(); ++a) axes_[a].add(row.cycle, period_s_, row.axes[a]);
}

CycleTimes::CycleTimes(std::vector<std::string> phase_names)
    : names_(std::move(phase_names)), phases_(names_.size()) {}

void CycleTimes::add(std::int64_t duration_ns, std::int64_t lateness_ns,
                     const std::int64_t* phases_ns) noexcept {
  duration_.add(duration_ns);
  lateness_.add(lateness_ns);
  for (std::size_t n = 0; n < phases_.size(); ++n) phases_[n].add(phases_ns[n]);
}

}  // namespace servogate::report
