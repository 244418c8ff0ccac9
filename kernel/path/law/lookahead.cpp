// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/lookahead.hpp"

#include <algorithm>

#include "kernel/path/law/s_curve.hpp"

namespace servogate::path {
namespace {

constexpr std::size_t kSmallestBatch = 32;  // spans
constexpr double kLongestBatch = 0.5;       // s
constexpr double kSlack = 1.0 - 1e-9;  ///< of a span's length, so that the follower's rounding finds room

double nominal(const Span& s) { return std::min(s.terms.box.velocity, s.terms.feed.speed); }

double over(double speed, const Span& s) { return reachable_speed(speed, s.length * kSlack, s.terms.box); }

/// Over any speed from 0 to `speed` at the other end: a change of speed down to rest may need less length
/// than one down to a low speed, because the S-curve takes its time at lower speeds.
double over_any(double speed, const Span& s) { return std::max(over(speed, s), over(0.0, s)); }

}  // namespace

void Lookahead::append(const Span& span) {
  Item item;
  item.span = span;
  item.span.number = next_++;
  item.span.terms.exit_limit = item.span.terms.exit_nominal = 0.0;
  item.span.final = false;
  spans_.push_back(item);
  ++fresh_;
  fresh_pieces_ += span.pieces;
  waiting_pieces_ += span.pieces;
  fresh_time_ += span.length / span.terms.box.velocity;
  // Batches that grow with the number of waiting spans keep the work per span constant.
  if (fresh_ >= std::max(kSmallestBatch, spans_.size() / 4) || fresh_time_ > kLongestBatch ||
      fresh_pieces_ > most_pieces_ / 8)
    settle(false);
}

void Lookahead::rest(bool confirm) {
  if (spans_.empty()) return;
  spans_.back().span.stop = true;
  spans_.back().span.confirm = confirm;
  settle(true);
}

void Lookahead::clear() {
  spans_.clear();
  fresh_ = fresh_pieces_ = waiting_pieces_ = arrived_ = 0;
  fresh_time_ = 0.0;
  entry_reach_ = entry_reach_nominal_ = 0.0;
}

void Lookahead::arrive(std::size_t i) {
  const Span& s = spans_[i].span;
  const Span& behind = spans_[i + 1].span;
  const double from = i == 0 ? entry_reach_ : spans_[i - 1].reach;
  const double from_nominal = i == 0 ? entry_reach_nominal_ : spans_[i - 1].reach_nominal;
  spans_[i].reach = std::min({over_any(from, s), s.terms.box.velocity, behind.terms.box.velocity});
  spans_[i].reach_nominal = std::min({over_any(from_nominal, s), nominal(s), nominal(behind)});
}

void Lookahead::pass_back() {
  for (std::size_t i = spans_.size(); i-- > 1;) {
    const Span& s = spans_[i].span;
    Item& before = spans_[i - 1];
    Span& b = before.span;
    const double limit =
        std::min({over_any(s.terms.exit_limit, s), s.terms.box.velocity, b.terms.box.velocity});
    const double at_feed = std::min({over(s.terms.exit_nominal, s), nominal(s), nominal(b), limit});
    if (before.published && limit == b.terms.exit_limit && at_feed == b.terms.exit_nominal) break;
    b.terms.exit_limit = limit;
    b.terms.exit_nominal = at_feed;
    before.changed = true;
  }
}

std::size_t Lookahead::settled(bool resting) const {
  if (resting) return spans_.size();
  for (std::size_t i = spans_.size() - 1; i-- > 0;)
    if (spans_[i].span.terms.exit_limit >= spans_[i].reach &&
        spans_[i].span.terms.exit_nominal >= spans_[i].reach_nominal)
      return i + 1;
  std::size_t count = 0, pieces = 0;
  if (waiting_pieces_ > most_pieces_)
    while (count + 1 < spans_.size() && pieces < waiting_pieces_ / 2) pieces += spans_[count++].span.pieces;
  return count;
}

void Lookahead::publish(std::size_t final_count) {
  std::size_t known = 0;
  while (known < spans_.size() && spans_[known].published) ++known;
  for (std::size_t i = known; i < spans_.size(); ++i) {
    spans_[i].span.final = i < final_count;
    sink_.put(spans_[i].span, false, i + 1 < spans_.size());
    spans_[i].published = true;
    spans_[i].changed = false;
  }
  for (std::size_t i = known; i-- > 0;) {
    const bool becomes_final = i < final_count;
    if (!spans_[i].changed && !becomes_final) continue;
    spans_[i].span.final = becomes_final;
    sink_.put(spans_[i].span, true, false);
    spans_[i].changed = false;
  }
}

void Lookahead::settle(bool resting) {
  fresh_ = fresh_pieces_ = 0;
  fresh_time_ = 0.0;
  if (spans_.empty()) return;
  while (arrived_ + 1 < spans_.size()) arrive(arrived_++);
  pass_back();
  const std::size_t final_count = settled(resting);
  publish(final_count);
  if (resting) {
    clear();
  } else if (final_count > 0) {
    entry_reach_ = std::min(spans_[final_count - 1].reach, spans_[final_count - 1].span.terms.exit_limit);
    entry_reach_nominal_ =
        std::min(spans_[final_count - 1].reach_nominal, spans_[final_count - 1].span.terms.exit_nominal);
    for (std::size_t i = 0; i < final_count; ++i) waiting_pieces_ -= spans_[i].span.pieces;
    spans_.erase(spans_.begin(), spans_.begin() + static_cast<std::ptrdiff_t>(final_count));
    arrived_ -= final_count;
  }
}

}  // namespace servogate::path
