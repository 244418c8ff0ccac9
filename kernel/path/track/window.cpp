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

void Window::append(const Entry& entry) noexcept {
  at(last_++) = entry;
  if (entry.kind == Entry::Kind::course) course_ = last_;
}

bool Window::extend(const Entry& known) noexcept {
  if (course_ <= first_ || at(course_ - 1).kind != Entry::Kind::course) return false;
  at(course_ - 1).extent = known.extent;
  return true;
}

}  // namespace servogate::path
