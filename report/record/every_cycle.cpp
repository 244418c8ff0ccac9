// SPDX-License-Identifier: Apache-2.0
#include "report/record/every_cycle.hpp"

#include <algorithm>

namespace servogate::report {

namespace {
constexpr std::size_t kLead = 3;            // a jerk is a third difference
constexpr std::size_t kAroundAlarm = 2048;  // rows on both sides of an alarm that belong to it
}  // namespace

EveryCycle::EveryCycle(std::vector<Channel> channels, std::size_t most_bytes)
    : channels_(std::move(channels)), most_bytes_(most_bytes), rows_(channels_.size()) {}

void EveryCycle::add(std::int64_t cycle, const std::vector<double>& values, bool alarm) {
  if (channels_.empty()) return;
  const auto held = static_cast<std::int64_t>(rows_.front().size());
  if (held > 0 && cycle != open_.first + held) close(false);
  if (rows_.front().empty()) open_.first = cycle;
  for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].push_back(values[c]);
  if (alarm) {
    open_.alarm = true;
    last_alarm_ = cycle;
    if (rows_.front().size() < kAroundAlarm && !stretches_.empty()) stretches_.back().alarm = true;
  }
  if (rows_.front().size() >= kRows + static_cast<std::size_t>(open_.lead)) close(true);
}

void EveryCycle::close(bool goes_on) {
  const std::size_t held = rows_.front().size(), lead = goes_on ? std::min(kLead, held) : 0;
  const std::int64_t next = open_.first + static_cast<std::int64_t>(held - lead);
  for (std::size_t c = 0; c < rows_.size(); ++c) {
    open_.columns.push_back(pack(rows_[c], channels_[c].quantum, channels_[c].order));
    open_.bytes += open_.columns.back().bytes.size();
    rows_[c].erase(rows_[c].begin(), rows_[c].end() - static_cast<std::ptrdiff_t>(lead));
  }
  bytes_ += open_.bytes;
  stretches_.push_back(std::move(open_));
  const bool just_now = last_alarm_ >= 0 && next - last_alarm_ < static_cast<std::int64_t>(kAroundAlarm);
  open_ = CycleStretch{next, static_cast<int>(lead), just_now, {}, 0};
  forget();
}

void EveryCycle::forget() {
  while (bytes_ > most_bytes_ && stretches_.size() > 1) {
    // The newest is where a run ended, so it stays in any case.
    auto gone = std::find_if(stretches_.begin(), stretches_.end() - 1,
                             [](const CycleStretch& s) { return !s.alarm; });
    if (gone == stretches_.end() - 1) gone = stretches_.begin();
    bytes_ -= gone->bytes;
    stretches_.erase(gone);
  }
}

void EveryCycle::finish() {
  if (!channels_.empty() && rows_.front().size() > static_cast<std::size_t>(open_.lead)) close(false);
}

}  // namespace servogate::report
