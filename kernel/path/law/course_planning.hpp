// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "kernel/path/law/course.hpp"
#include "kernel/path/law/course_law.hpp"
#include "kernel/path/law/pipeline.hpp"
#include "kernel/path/law/rate.hpp"

namespace servogate::path {

/// The law over one clock outside the cycle: takes runs of elements, and gives knots with the stops that are
/// known on them. A stop is looked for behind each knot of `kStopEvery`, as soon as the knots are there that
/// it may need, counted in knots: what is given depends on the elements alone. Not real-time safe.
class CoursePlanning final : public CourseLaw, private KnotSink {
 public:
  CoursePlanning(const Config& config, CourseSink& sink);

  void put(const Leg& leg) override;
  void cruise(const Leg& leg, double speed) override;
  void rest(bool confirm) override;
  bool work() override;
  bool ends() const override { return confirm_.has_value() && !broken_; }
  bool broken() const override { return broken_; }
  Rest rest_place() const override { return rest_; }
  double sure() const override { return sure_; }
  void restart() override;
  const Pipeline::Counts& counts() const { return pipeline_.counts(); }

  static constexpr std::int64_t kStopEvery = 8;  // knots

 private:
  /// The knots of the course that are kept here.
  class View final : public CourseView {
   public:
    const Knot* knot(std::int64_t n) const noexcept override {
      const std::int64_t at = n + 2;
      return at >= static_cast<std::int64_t>(knots.begin()) && at < static_cast<std::int64_t>(knots.end())
                 ? &knots[static_cast<std::size_t>(at)]
                 : nullptr;
    }
    std::int64_t end() const noexcept override { return complete ? last() : -1; }
    std::int64_t last() const noexcept { return static_cast<std::int64_t>(knots.end()) - 3; }
    Kept<Knot> knots;
    bool complete = false;
  };
  void begin(const Vector& before_last, const Vector& last) override;
  void put(const Knot& knot) override;
  void rest() override;
  void cruise(const Cruise& cruise) override;
  void straight(const Cruise& cruise, const Knot& before, double length);
  void arc(const Cruise& cruise, const Knot& before);
  void place(Leg leg);
  void append(const Knot& knot);
  void look_for_break();
  void find_stops();
  void give();
  void give_pieces(const Knot& to);

  Config config_;
  CourseSink& sink_;
  RateLimits limits_;
  Pipeline pipeline_;
  View view_;
  CourseExtent extent_;
  bool begun_ = false;   ///< a course is
  bool broken_ = false;  ///< and it cannot be driven to its end
  Rest rest_;
  double sure_ = 0.0;
  bool joins_ = false;           ///< the next run begins behind a cruise
  std::optional<bool> confirm_;  ///< its rest is known: see CourseExtent
  double length_ = 0.0;          ///< of the legs so far
  double section_ = 0.0;         ///< where the run in work begins
  struct Span {
    double begin, end;
  };
  std::deque<Span> cruises_;  ///< behind it, and behind those that follow
  LawTime base_;              ///< the same as time
  std::deque<Piece> pieces_;  ///< that no knot given lies on yet
  std::size_t given_ = 0;     ///< knots
  double given_until_ = 0.0;  ///< law time of the last of them
  std::int64_t looked_ = 0;   ///< knots before this have had their stop looked for
  std::int64_t look_at_ = 0;  ///< not before this knot is there
  StopHint stop_;
};

}  // namespace servogate::path
