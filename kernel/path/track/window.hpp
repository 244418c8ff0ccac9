// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/path/track/track.hpp"

namespace servogate::path {

/// The course in motion as far as the follower may see it. real-time safe.
class CourseAhead final : public CourseView {
 public:
  explicit CourseAhead(const Track& track) noexcept : track_(&track) {}

  /// Takes it up, or sees it further.
  void take(const Entry& course) noexcept { course_ = &course; }
  const CourseExtent& extent() const noexcept { return course_->extent; }
  const Knot* knot(std::int64_t number) const noexcept override {
    const auto n = static_cast<std::uint64_t>(number + 2);
    return number >= -2 && n < extent().knots ? &track_->knots[course_->first_knot + n] : nullptr;
  }
  std::int64_t end() const noexcept override {
    return extent().complete ? static_cast<std::int64_t>(extent().knots) - 3 : -1;
  }
  StopHint guard() const noexcept override {
    return extent().stops > 0 ? track_->stops[course_->first_stop + extent().stops - 1] : StopHint{};
  }
  StopHint stop_near(std::int64_t knot) const noexcept override;
  const LawTime* rests_at() const noexcept override {
    return extent().broken && extent().stops > 0 ? &extent().rest : nullptr;
  }
  /// What lies so far behind that nobody looks at it: numbers in the rings of the track.
  std::uint64_t knots_behind(std::int64_t knot) const noexcept;
  std::uint64_t stops_behind(std::int64_t knot) const noexcept;
  /// First numbers behind what is known of the course.
  Track::Begin behind() const noexcept;

 private:
  const Track* track_;
  const Entry* course_ = nullptr;
};

/// The follower's end of the track: entries that were taken over and are not done, in order. The constructor
/// allocates; the rest is real-time safe.
class Window final : public Ahead {
 public:
  explicit Window(const Track& track) : slots_(track.entries.capacity()) {}

  bool full() const noexcept { return last_ - first_ >= slots_.size(); }
  bool empty() const noexcept { return first_ == last_; }

  void append(const Entry& entry) noexcept;
  /// The last course is known further. False: there is none.
  bool extend(const Entry& known) noexcept;
  /// The first entry, if it is a course.
  const Entry* course() const noexcept {
    return !empty() && front().kind == Entry::Kind::course ? &front() : nullptr;
  }
  const Entry& front() const noexcept { return slots_[front_]; }
  void pop() noexcept {
    ++first_;
    front_ = front_ + 1 < slots_.size() ? front_ + 1 : 0;
  }
  void clear() noexcept {
    first_ = last_;
    front_ = first_ % slots_.size();
  }

  const Span* span(int n) const noexcept override {
    const auto beyond = static_cast<std::uint64_t>(n);
    if (first_ + beyond >= last_) return nullptr;
    const std::uint64_t at = front_ + beyond;
    const Entry& entry = slots_[at < slots_.size() ? at : at - slots_.size()];
    return entry.kind == Entry::Kind::span ? &entry.span : nullptr;
  }

 private:
  Entry& at(std::uint64_t n) noexcept { return slots_[n % slots_.size()]; }

  std::vector<Entry> slots_;            ///< a ring
  std::uint64_t first_ = 0, last_ = 0;  ///< entries in use
  std::uint64_t front_ = 0;             ///< slot of the first
  std::uint64_t course_ = 0;            ///< number of the last course, + 1; 0: none
};

}  // namespace servogate::path
