// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/path_ramp.hpp"
#include "kernel/path/law/stop_search.hpp"

namespace servogate::path {

/// Follows a course at a rate that changes. One cycle looks at no more than so many places of a change. While
/// the end of the course is not published, no change is entered that does not end before the last stop that
/// is, and there the motion stops. That is how it comes to where a broken course rests; what a hold has left
/// of the way there is gone from rest to rest.
class RateMotion {
 public:
  static constexpr int kMostPlaces = 1000;  // a cycle
  static constexpr int kTry = 6;            // that a try counts for by itself

  explicit RateMotion(const RateLimits& limits) noexcept : limits_(limits) {}
  /// At the start of a course, which rests there: any rate is at once.
  void begin(double rate) noexcept;
  /// One cycle on: `target` is the rate that is wanted, -1 to 1, or above where the path allows it: a rate
  /// above 1 is entered together with a way back to 1, and kept while that can be put off. A lower rate from
  /// 1 is settled in the cycle in which it is first wanted: what is not found at once begins as the next
  /// known stop, out of which the search goes on. False: the law time has come to the end of the course, to
  /// its start backwards, or to where it rests if it is broken.
  bool step(const CourseView& view, double target, double period) noexcept;
  CoursePoint point(const CourseView& view) const noexcept;
  /// -1 to 1, or above 1 where that is wanted; on a ramp up to 2 % beyond (PathRamp).
  double rate() const noexcept { return rate_; }
  const LawTime& time() const noexcept { return time_; }
  std::int64_t knot() const noexcept { return knot_; }
  /// A change is on its way, or settled: it begins in the knot of a stop that is known, a few ahead.
  bool changing() const noexcept { return active_ || settled_; }
  bool at_rest() const noexcept { return !active_ && rate_ == 0.0; }
  /// A change is on its way.
  bool underway() const noexcept { return active_; }
  /// It stops, or stands, because the course is not published any further.
  bool starving() const noexcept { return starving_; }
  double wanted() const noexcept {
    return !active_ ? rate_ : change_.way != 0.0 ? searched_for_ : change_.r1;
  }
  /// Looked at in the last cycle, and knots that were passed to plan a ramp.
  int places() const noexcept { return kMostPlaces - left_; }

 private:
  void advance(const CourseView& view, double period) noexcept;
  void advance_on_ramp(const CourseView& view, double period) noexcept;
  void start(const RateChange& change) noexcept;
  RateState change_at(double t) const noexcept { return on_plan_ ? plan_.at(t) : change_.at(t); }
  bool ramp(const CourseView& view, double target, double period) noexcept;
  bool slows_down(const CourseView& view) const noexcept;
  bool early(const CourseView& view, double target, double period) noexcept;
  bool follow_ramp(const CourseView& view, double target, double period, int& places) noexcept;
  Fit enter(const CourseView& view, double target, double seconds, int power, double period) noexcept;
  bool stop_at(const CourseView& view, const StopHint& hint, double period) noexcept;
  double until(const CourseView& view, const StopHint& hint) const noexcept;
  bool stop_in_time(const CourseView& view, double target, double period) noexcept;
  bool level_off(const CourseView& view, double period) noexcept;
  void search(const CourseView& view, double target, double period) noexcept;
  bool foresee(const CourseView& view, double in, CourseState& at) const noexcept;
  void prepare(const CourseView& view, double target, double seconds, int power, double period) noexcept;
  bool preparing(const CourseView& view) noexcept;
  void begin_prepared(double target) noexcept;
  bool is_at(const LawTime& time, double rate, double slope) const noexcept;
  double seconds_to_rest(const CourseView& view) const noexcept;
  void begin_sooner_stop() noexcept;
  void seek_sooner_stop(const CourseView& view, double period) noexcept;
  bool near_last_stop(const CourseView& view) const noexcept;
  void creep(const CourseView& view, double target) noexcept;
  bool rests_there(const CourseView& view) noexcept;
  static bool beyond_rest(const CourseView& view, const LawTime& at) noexcept;
  void seek(const CourseView& view, double target, double period) noexcept;
  void surge(const CourseView& view, double target, double period) noexcept;
  void put_off(const CourseView& view, double period) noexcept;
  bool come_back(const CourseView& view, double period) noexcept;

  RateLimits limits_;
  LawTime time_;
  std::int64_t knot_ = 1;
  double rate_ = 1.0, slope_ = 0.0;
  RateChange change_;
  PathRamp ramp_;            ///< goes before the change
  bool ramp_tried_ = false;  ///< in the cycle before, in vain
  double into_ = 0.0;        ///< the ramp, or the change, s
  bool active_ = false, on_ramp_ = false, on_plan_ = false;
  bool starving_ = false, settled_ = false, stuck_ = false;
  double searched_for_ = 2.0;  ///< target of the search
  double next_ = 0.0;          ///< length to try next
  double share_ = 1.0;         ///< of the target, where not enough is published for all of it
  int power_ = 3, left_ = kMostPlaces;
  /// A change that takes more than a cycle to verify, and begins where the motion will be by then.
  struct Prepared {
    int cycles = 0;  ///< until it begins; 0: there is none
    bool fits = false;
    Verification verification;
  };
  static constexpr int kAtRest = 1 << 30;  ///< cycles: it begins as soon as it is verified
  Prepared prepared_;
  int needed_ = 0;  ///< places of the change that was tried last, if they were not enough
  /// A stop that rests sooner than the one on its way, or settled, is looked for.
  struct Sooner {
    int cycles = 0;  ///< until it begins; 0: none is looked for
    bool fits = false;
    int pause = 0, in_vain = 0;  ///< cycles until the next search, and searches in vain
  };
  Sooner sooner_;
  StopSearch stop_search_;
  StopPlan plan_;          ///< what on_plan_ follows
  bool levels_ = false;    ///< the change in progress leads to a constant rate, from which the search goes on
  bool creeping_ = false;  ///< next_ is the length of a way from rest to rest
  RateChange back_;        ///< from above 1
  double back_in_ = 0.0;   ///< s at the present rate until it begins
  int surges_tried_ = 0;
};

}  // namespace servogate::path
