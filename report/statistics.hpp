// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "report/trace.hpp"

namespace servogate::report {

/// Durations in nanoseconds, counted in buckets whose width grows with the value (64 a doubling): bounded
/// memory, and a quantile that is at most 1/64 above the true one and never below it. Values above 2^40 ns
/// count as 2^40 ns.
class Histogram {
 public:
  Histogram();
  /// Counts one value; negative ones count as 0. real-time safe.
  void add(std::int64_t ns) noexcept;
  std::uint64_t count() const noexcept { return count_; }
  std::int64_t max() const noexcept { return max_; }
  double mean() const noexcept;
  /// Smallest bucket edge that at least the share `q` (0-1) of all values does not exceed; the exact maximum
  /// for 1, 0 when empty. real-time safe (one pass over the buckets).
  std::int64_t quantile(double q) const noexcept;

  /// One filled bucket: values from `from` to `to` inclusive.
  struct Bucket {
    std::int64_t from, to;
    std::uint64_t count;
  };
  /// Filled buckets in rising order. Not real-time safe.
  std::vector<Bucket> buckets() const;

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
  double sum_ = 0.0;
};

/// Largest magnitudes of one axis; mm or degrees, seconds. Derivatives are backward differences of the
/// set-points over one cycle, taken only across cycles in which the axis was enabled, without a gap, in
/// unchanged coordinates.
class AxisStatistics {
 public:
  /// Adds one cycle. real-time safe.
  void add(std::int64_t cycle, double period_s, const TraceAxis& axis) noexcept;
  double max_velocity() const noexcept { return max_[0]; }
  double max_acceleration() const noexcept { return max_[1]; }
  double max_jerk() const noexcept { return max_[2]; }
  double max_following_error() const noexcept { return max_error_; }
  /// Derivatives of the newest cycle, 0 where too few cycles stand behind it: velocity, acceleration, jerk.
  const std::array<double, 3>& derivatives() const noexcept { return now_; }
  /// How many of them have enough cycles behind them, 0 to 3.
  int derived() const noexcept { return derived_; }

 private:
  int known_ = 0;  ///< how many of position, velocity, acceleration of the last cycle are valid
  int derived_ = 0;
  std::int64_t last_cycle_ = 0;
  bool last_homed_ = false;
  double position_ = 0.0;
  std::array<double, 3> now_{};
  std::array<double, 3> max_{};
  double max_error_ = 0.0;
};

/// What a run amounts to, kept online: feed it every row.
class RunStatistics {
 public:
  explicit RunStatistics(const TraceLayout& layout);
  /// real-time safe.
  void add(const TraceRow& row) noexcept;
  const std::vector<AxisStatistics>& axes() const noexcept { return axes_; }
  std::uint64_t cycles() const noexcept { return cycles_; }

 private:
  double period_s_;
  std::vector<AxisStatistics> axes_;
  std::uint64_t cycles_ = 0;
};

/// Timing of the cycle: its duration, how late the thread woke up, and each phase by name.
class CycleTimes {
 public:
  explicit CycleTimes(std::vector<std::string> phase_names = {});
  /// Adds one cycle. `phases_ns` has as many entries as there are names. real-time safe.
  void add(std::int64_t duration_ns, std::int64_t lateness_ns, const std::int64_t* phases_ns) noexcept;
  const Histogram& duration() const noexcept { return duration_; }
  const Histogram& lateness() const noexcept { return lateness_; }
  const std::vector<std::string>& phase_names() const noexcept { return names_; }
  const Histogram& phase(std::size_t n) const noexcept { return phases_[n]; }

 private:
  Histogram duration_, lateness_;
  std::vector<std::string> names_;
  std::vector<Histogram> phases_;
};

}  // namespace servogate::report
