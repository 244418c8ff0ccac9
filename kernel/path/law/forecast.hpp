// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "kernel/path/law/course.hpp"
#include "kernel/path/law/course_law.hpp"
#include "kernel/path/law/moment.hpp"

namespace servogate::path {

/// Tells how fast a run will be driven, and what binds it there, from the programmed path alone: no curve and
/// no law is made. Each place has a largest speed, by the feed, by its corner, and by the differences of the
/// path over all scales that matter; jerk and acceleration bound how that changes along the path. Its time is
/// right to a fiftieth where the feed is reached, to a tenth where the limits bind, to a sixth in zigzags
/// that are corners throughout (tests/path/forecast_test.cpp), on curves that the jerk binds from end to end
/// a fifth too slow at worst; single moves of tenths of a second may be further off. Works in windows whose
/// bounds go with the length of the path and not with what has arrived. Not real-time safe.
class SpeedForecast {
 public:
  SpeedForecast(int axes, const Transformation& transformation, MomentSink& sink)
      : axes_(axes), transformation_(&transformation), sink_(sink) {}

  /// A new run, at the speed that it begins with.
  void clear(double speed);
  /// Tells all of the run that can be told now; `ended`: nothing more is appended to it.
  void work(const Run& run, bool ended);
  /// Legs before this are no longer looked at.
  double needs_from() const { return begin_; }
  /// s, of what has been told since clear().
  double seconds() const { return seconds_; }

 private:
  struct Why {
    Brake brake = Brake::shape;
    std::int8_t axis = -1;
  };
  struct Node {
    double u, y;
    Why why;
  };
  struct Place {
    Vector at;  // of the axes
    const Leg* leg;
    double turns;                         // of the spindle; 0: the same all along the leg
    double cap, jerk_root, acceleration;  // speed, and along the path
    Why why, jerk_why, acceleration_why;
    int bends;  // before it, in the window
  };
  /// A change of direction, between ways without one.
  struct Bend {
    double u, before, after, cosine, tolerance, corner;
    double turn;  // of the axis that turns most
    std::int8_t axis;
    double jerk, acceleration, speed;  // of the axis that is first at its limit
  };
  bool window(const Run& run, bool ended);
  double length_of_window(const Run& run);
  void place(const Run& run, double end);
  void limit();
  void find_bends(const Run& run, double end);
  Bend bend(const Leg& before, const Leg& after) const;
  double speed_at(const Bend& bend) const;
  void limit_over(std::size_t steps);
  void cap(std::size_t from, std::size_t count, double speed, Why why);
  void make_nodes(const Run& run, double end, bool last);
  void nodes_around(double u, double y, Why why, double tolerance, double end);
  double reach(const Node& from, Node& to, double share) const;
  void reach_between();
  void tell(bool last);
  std::size_t place_at(double u) const;

  int axes_;
  const Transformation* transformation_;
  MomentSink& sink_;
  double begin_ = 0.0, begin_y_ = 0.0, wait_ = 0.0, seconds_ = 0.0, last_bend_ = 0.0;
  bool done_ = false;
  // One window.
  double spacing_ = 0.0, feed_ = 0.0, free_to_ = 0.0, scale_ = 0.0;
  std::vector<Place> places_;
  std::vector<Bend> bends_;
  std::vector<Node> nodes_, more_, sorted_;
};

/// Courses of a path that is told and not driven: runs in; moments, and the time from rest to rest out.
class CourseForecast final : public CourseLaw {
 public:
  CourseForecast(const Config& config, MomentSink& moments, CourseSink& sink);

  void put(const Leg& leg) override;
  void cruise(const Leg& leg, double speed) override;
  void rest(bool confirm) override;
  bool work() override { return false; }
  bool ends() const override { return false; }
  bool broken() const override { return false; }
  Rest rest_place() const override { return {}; }
  double sure() const override { return std::numeric_limits<double>::infinity(); }
  void restart() override;

 private:
  void begin();
  void end_run(double speed);

  int axes_;
  const Transformation* transformation_;
  MomentSink& moments_;
  CourseSink& sink_;
  Run run_;
  SpeedForecast speed_;
  double seconds_ = 0.0;
  bool begun_ = false;
};

}  // namespace servogate::path
