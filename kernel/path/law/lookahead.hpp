// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>

#include "kernel/path/law/span.hpp"

namespace servogate::path {

/// The speeds between spans: how fast the end of each span may be passed so that everything behind it can be
/// driven, with a rest at the end of what is known. A span is final once no later program can change how it
/// is driven: when its end may be passed as fast as it can be reached at all. Spans that are not final are
/// published too, as the way to rest should planning be late, and raised later, farthest first, so that each
/// state in between is drivable. Not real-time safe.
class Lookahead {
 public:
  /// `most_pieces`: when more pieces of geometry are waiting, the older half becomes final as it is, so that
  /// the track has room for both what is final and what is not.
  Lookahead(std::size_t most_pieces, SpanSink& sink) : most_pieces_(most_pieces), sink_(sink) {}

  /// Appends a span (its number, exits and `final` are filled here).
  void append(const Span& span);
  /// The path rests behind the last span appended; everything becomes final.
  void rest(bool confirm);
  /// Forgets the spans that are not final; they must not have been put, or be dropped by the follower.
  void clear();
  /// Number of the last span appended; markers carry it.
  std::uint64_t last_number() const { return next_ - 1; }
  /// Spans waiting to be final.
  std::size_t waiting() const { return spans_.size(); }

 private:
  struct Item {
    Span span;
    double reach = 0.0, reach_nominal = 0.0;  ///< fastest arrival at the end of the span
    bool published = false, changed = false;
  };
  void settle(bool resting);
  void arrive(std::size_t i);
  void pass_back();
  std::size_t settled(bool resting) const;
  void publish(std::size_t final_count);

  std::size_t most_pieces_;
  SpanSink& sink_;
  std::deque<Item> spans_;
  std::uint64_t next_ = 1;
  std::size_t waiting_pieces_ = 0, fresh_pieces_ = 0;
  double fresh_time_ = 0.0;
  std::size_t fresh_ = 0;     ///< appended since the last pass
  std::size_t arrived_ = 0;   ///< spans whose reach is known
  double entry_reach_ = 0.0;  ///< fastest arrival at the first waiting span
  double entry_reach_nominal_ = 0.0;
};

}  // namespace servogate::path
