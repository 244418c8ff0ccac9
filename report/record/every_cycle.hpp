// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "report/record/column.hpp"

namespace servogate::report {

/// A value of each cycle, and how finely it is kept.
struct Channel {
  std::string name;
  double quantum = 1.0;
  int order = 1;
};

/// Cycles without a gap: a column per channel. The first `lead` rows belong to the stretch before and stand
/// here so that differences can be taken from the first own row on.
struct CycleStretch {
  std::int64_t first = 0;  ///< cycle of the first row, with the lead
  int lead = 0;
  bool alarm = false;  ///< an alarm came up in it, or within two thousand cycles of it
  std::vector<Column> columns;
  std::size_t bytes = 0;
};

/// Every cycle of a run in bounded memory. When it grows too long the oldest stretches go, those around an
/// alarm last. Not real-time safe.
class EveryCycle {
 public:
  static constexpr std::size_t kRows = 8192;  ///< of a stretch
  EveryCycle(std::vector<Channel> channels, std::size_t most_bytes);
  /// One cycle: a value per channel; `alarm`: one came up in it. A number that does not follow the last
  /// begins a new stretch.
  void add(std::int64_t cycle, const std::vector<double>& values, bool alarm);
  /// Packs what is left; then stretches() is final.
  void finish();
  const std::vector<Channel>& channels() const noexcept { return channels_; }
  const std::deque<CycleStretch>& stretches() const noexcept { return stretches_; }

 private:
  void close(bool goes_on);
  void forget();

  std::vector<Channel> channels_;
  std::size_t most_bytes_;
  std::vector<std::vector<double>> rows_;  ///< of the open stretch, by channel
  CycleStretch open_;
  std::deque<CycleStretch> stretches_;
  std::size_t bytes_ = 0;
  std::int64_t last_alarm_ = -1;
};

}  // namespace servogate::report
