// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/path_time.hpp"

#include <cmath>

namespace servogate::path {
PathTime::PathTime(const Config& config, const Vector& start)
    : config_(config), track_(config_), planner_(config_, track_, Planner::For::forecast) {
  planner_.restart(start);
}

bool PathTime::add(const Element& element) {
  if (!planner_.add(element)) return false;
  take_entries();
  return true;
}

void PathTime::rest() {
  planner_.finish();
  take_entries();
}

void PathTime::take_entries() {
  for (planner_.work(); taken_ < track_.entries.written(); planner_.work()) {
    for (; taken_ < track_.entries.written(); track_.entries.free_below(++taken_)) {
      const Entry& entry = track_.entries[taken_];
      if (entry.kind == Entry::Kind::span) spans_.push_back(entry.span);
      if (entry.kind == Entry::Kind::extend) {  // from rest to rest: all spans before it are final
        time_spans();
        seconds_ += whole_cycles(entry.extent.seconds);
        continue;
      }
      if (entry.kind != Entry::Kind::revise || spans_.empty() || entry.span.number < spans_.front().number)
        continue;
      // Numbers of spans run without a gap.
      spans_[static_cast<std::size_t>(entry.span.number - spans_.front().number)] = entry.span;
    }
    track_.pieces.free_below(track_.pieces.written());
  }
  time_spans();
}

double PathTime::whole_cycles(double seconds) const {
  return std::ceil(seconds / config_.period_s - 1e-6) * config_.period_s;
}

void PathTime::time_spans() {
  while (!spans_.empty() && spans_.front().final && (spans_.front().stop || spans_.size() > 1)) {
    const Span span = spans_.front();
    spans_.pop_front();
    way_ += timing_.through(span, span.stop ? nullptr : &spans_.front());
    if (!span.stop) continue;
    seconds_ += whole_cycles(way_);
    way_ = 0.0;
  }
}

}  // namespace servogate::path
