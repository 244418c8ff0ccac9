// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "kernel/path/law/stop_plan.hpp"

namespace servogate::path {

/// Looks for the soonest stop from a state of a course: piece by piece, from the most promising rates on,
/// with some bends between the least and the largest one that all axes leave there (a beam search). What it
/// finds has been verified to its end. Goes on in a later cycle where it was left. Real-time safe; the result
/// depends on the course and the state alone, and on how often `conclude` was true.
class StopSearch {
 public:
  /// `from`: where the motion will be; `within`: s, only sooner stops count.
  void begin(const CourseState& from, double within) noexcept;
  /// Counts the places down that it looks at, and stops at 0 or up to kPast below. `conclude`: time is up,
  /// the best stop so far will do. fits: plan() is verified; breaks: there is none; open: to be gone on with.
  Fit go(const CourseView& view, const RateLimits& limits, bool conclude, int& places) noexcept;
  static constexpr int kPast = 128;
  const CourseState& from() const noexcept { return from_; }
  const StopPlan& plan() const noexcept { return verification_.change(); }
  /// Where the plan comes to rest.
  LawTime rests_at() const noexcept { return from_.time.plus(plan().at(plan().seconds).passed); }

 private:
  static constexpr std::size_t kWidth = 4;                 // states that are followed at a time
  static constexpr std::size_t kOptions = 6, kPieces = 4;  // of a step
  static constexpr std::size_t kMostSteps = StopPlan::kMostPieces / kPieces;
  using Bends = std::array<double, kPieces>;
  struct Range {
    double least = -std::numeric_limits<double>::infinity(),
           largest = std::numeric_limits<double>::infinity();
  };
  /// A state on the way, and how it came there.
  struct Node {
    double passed = 0.0, rate = 0.0, slope = 0.0;  // all in the sense of the motion
    Range range;                                   // of the bends there
    double score = 0.0;
    std::int64_t knot = 1;
    std::uint8_t parent = 0;
    Bends bends{};
    void go(double bend, double seconds) noexcept;
  };
  struct Step {
    Bends bends{};
    std::uint8_t parent = 0;
  };
  /// A place of the course, and what the axes are there.
  struct Spot {
    explicit Spot(const CourseView& view, std::int64_t knot) noexcept : place(view) { place.set_knot(knot); }
    bool go(const CourseView& view, const RateLimits& limits, const LawTime& at) noexcept;
    bool inside(const LawTime& at) noexcept;
    CoursePlace place;
    Interval interval;
    double in = 0.0;
  };
  LawTime time_at(double passed) const noexcept;
  bool bends(const Spot& spot, double in, const RateLimits& limits, double rate, double slope, Range& range,
             int& places) const noexcept;
  bool pass(const CourseView& view, const RateLimits& limits, Spot& spot, const Node& from, const Node& to,
            Range& range, int& places) const noexcept;
  bool follow(const CourseView& view, const RateLimits& limits, Spot& spot, std::size_t number, Node& node,
              int& places) const noexcept;
  bool closes(const CourseView& view, const RateLimits& limits, const Spot& spot, const Node& node,
              double before, int& places) const noexcept;
  void expand(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  void keep(const Node& node) noexcept;
  bool next_step() noexcept;
  void make_plan() noexcept;

  CourseState from_;
  double sense_ = 1.0;  // -1: backwards
  double full_ = 1.0;   // the rate does not exceed it
  double piece_ = 0.002, best_ = 0.0;
  Interval here_;  // where the states are that are followed
  std::size_t step_ = 0, node_ = 0, option_ = 0;
  std::size_t last_step_ = 0;  // of the best stop so far
  Node last_;                  // its state where the last piece begins
  bool found_ = false, verifying_ = false;
  std::array<Node, kWidth> now_{};
  std::array<Node, kWidth * kOptions> next_{};
  std::size_t count_ = 0, next_count_ = 0;
  std::array<std::array<Step, kWidth>, kMostSteps> steps_{};
  VerificationOf<StopPlan> verification_;
};

}  // namespace servogate::path
