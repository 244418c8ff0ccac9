// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <utility>

#include "kernel/path/law/rate.hpp"
#include "kernel/path/planner.hpp"
#include "kernel/path/track/window.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {

/// The first course of a program, whose law is that of courses, as the planner publishes it, whole, with its
/// cruises and stops: copies of a motion along it may be tried at will.
class PublishedCourse final : public CourseView {
 public:
  explicit PublishedCourse(RandomProgram program)
      : p(std::move(program)), track_(p.config), planner_(p.config, track_), ahead_(track_) {
    limits.axes = p.config.axis_count;
    limits.limits = p.config.limits;
    planner_.restart(p.start);
    for (const Element& e : p.elements) planner_.add(e);
    planner_.finish();
    planner_.work();
    for (std::uint64_t k = 0; k < track_.visible(); ++k) {
      const Entry& entry = track_.entries[k];
      if (entry.kind == Entry::Kind::course) course_ = entry;
      if (entry.kind == Entry::Kind::extend) course_.extent = entry.extent;
    }
    ahead_.take(course_);
  }
  PublishedCourse(const PublishedCourse&) = delete;
  PublishedCourse& operator=(const PublishedCourse&) = delete;

  bool whole() const { return course_.extent.complete && !planner_.waits(); }
  const Knot* knot(std::int64_t n) const noexcept override {
    return n < hidden_from && n >= hidden_below ? ahead_.knot(n) : nullptr;
  }
  std::int64_t end() const noexcept override { return ahead_.end(); }
  /// As the follower finds it, which frees those that it has passed.
  StopHint stop_near(std::int64_t n) const noexcept override {
    std::uint64_t low = course_.first_stop, high = low + course_.extent.stops;
    if (low == high) return {};
    const std::uint64_t last = high - 1;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (track_.stops[middle].knot < n)
        low = middle + 1;
      else
        high = middle;
    }
    return track_.stops[std::min(low, last)];
  }

  RandomProgram p;
  RateLimits limits;
  std::int64_t hidden_from = 1LL << 40, hidden_below = -10;  ///< knots that cannot be seen any more

 private:
  Track track_;
  Planner planner_;
  CourseAhead ahead_;
  Entry course_;
};

}  // namespace servogate::path::test
