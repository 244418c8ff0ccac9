// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/track/publisher.hpp"

#include <algorithm>

namespace servogate::path {
namespace {

constexpr double kPlannedAhead = 2.0;  // s

}  // namespace

void Publisher::put(const Span& span, bool revised, bool more) {
  Entry& entry = entries_.emplace_back();
  entry.kind = revised ? Entry::Kind::revise : Entry::Kind::span;
  entry.more = more;
  entry.span = span;
  if (span.final) final_time_ = std::max(final_time_, span.time);
}

Track::Begin Publisher::next() const {
  return {track_.entries.written() + entries_.size(), track_.pieces.written() + pieces_.size()};
}

void Publisher::work() {
  while (!pieces_.empty() && track_.pieces.push(pieces_.front())) pieces_.pop_front();
  const std::uint64_t there = track_.pieces.written();
  while (!entries_.empty()) {
    const Entry& entry = entries_.front();
    if (entry.kind == Entry::Kind::span && entry.span.first_piece + entry.span.pieces > there) break;
    if (!track_.entries.push(entry)) break;
    entries_.pop_front();
  }
}

bool Publisher::wants_more() const {
  if (!entries_.empty()) return false;
  const std::uint64_t passed = track_.pieces.freed(), there = track_.pieces.written();
  return passed >= there || final_time_ - track_.pieces[passed].time < kPlannedAhead;
}

}  // namespace servogate::path
