// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/track/window.hpp"

#include <algorithm>

namespace servogate::path {

StopHint CourseAhead::stop_near(std::int64_t knot) const noexcept {
  const std::uint64_t first = std::max(track_->stops.freed(), course_->first_stop),
                      end = course_->first_stop + extent().stops;
  StopHint found;
  // They are freed as the motion passes them, up to one behind it.
  for (std::uint64_t n = first; n < std::min(end, first + 4); ++n) {
    found = track_->stops[n];
    if (found.knot >= knot) break;
  }
  return found;
}

std::uint64_t CourseAhead::knots_behind(std::int64_t knot) const noexcept {
  constexpr std::int64_t kLookedAt = 8;
  return course_->first_knot + static_cast<std::uint64_t>(std::max<std::int64_t>(0, knot + 2 - kLookedAt));
}

std::uint64_t CourseAhead::stops_behind(std::int64_t knot) const noexcept {
  constexpr int kMost = 8;  // passed in a cycle
  std::uint64_t n = std::max(track_->stops.freed(), course_->first_stop);
  const std::uint64_t end = course_->first_stop + extent().stops;
  for (int k = 0; k < kMost && n + 1 < end && track_->stops[n + 1].knot < knot; ++k) ++n;
  return n;
}

Track::Begin CourseAhead::behind() const noexcept {
  Track::Begin out;
  out.piece = course_->span.first_piece + extent().pieces;
  out.knot = course_->first_knot + extent().knots;
  out.stop = course_->first_stop + extent().stops;
  return out;
}

void Window::stage(const Entry& entry) noexcept {
  at(staged_++) = entry;
  if (entry.kind == Entry::Kind::course) course_ = staged_;
  if (!entry.more) last_ = staged_;
}

bool Window::extend(const Entry& known) noexcept {
  if (course_ <= first_ || at(course_ - 1).kind != Entry::Kind::course) return false;
  at(course_ - 1).extent = known.extent;
  return true;
}

bool Window::revise(const Span& update) noexcept {
  // Numbers rise along the window, and a marker carries the number of the span before it: the first entry
  // that is not below is the span, if it is still there.
  std::uint64_t low = first_, high = last_;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (at(middle).span.number < update.number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == last_ || at(low).kind != Entry::Kind::span || at(low).span.number != update.number) return false;
  Span& span = at(low).span;
  span.terms = update.terms;
  span.final = update.final;
  span.stop = update.stop;
  span.confirm = update.confirm;
  return low == first_;
}

}  // namespace servogate::path
