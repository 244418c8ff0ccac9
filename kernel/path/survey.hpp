// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {

/// What keeps a path below its programmed feed.
enum class Brake : std::uint8_t {
  rest,          ///< it rests there: an exact stop, an event, its begin and end
  velocity,      ///< of an axis
  acceleration,  ///< the same
  jerk,          ///< the same
  shape,         ///< no limit is reached: a corner is rounded within the tolerance, or the way is too short
};

/// A part of a path where it is slower than programmed.
struct SlowPlace {
  Tag first, last;       ///< elements where it begins and ends
  int times = 1;         ///< that the path passes them so
  double seconds = 0.0;  ///< that it takes, all times together
  double lost = 0.0;     ///< of these: what the same way would not take at the programmed feed
  double slowest = 0.0;  ///< mm/s
  double feed = 0.0;     ///< programmed there, mm/s
  Brake brake = Brake::shape;
  int axis = -1;  ///< path axis of a limit
};

/// Drives a path cycle by cycle as the machine would at 100 %, and finds where it is slow and why: what takes
/// most of the time there. Rapids are as fast as the limits, and are not looked at. In-position waiting is
/// not counted. Memory is bounded. Not real-time safe.
class Survey {
 public:
  Survey(const Config& config, const Vector& start);

  /// Appends an element; its tag comes back in the places. False: it cannot be driven, last_flaw() says why,
  /// and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return planner_.last_flaw(); }
  /// The path comes to rest behind the elements added so far.
  void rest();
  /// Time of all motion up to the last rest, s, in whole cycles.
  double seconds() const { return static_cast<double>(cycles_) * config_.period_s; }
  /// The places that cost most, those first, at most kMost.
  std::vector<SlowPlace> slowest() const;
  static constexpr std::size_t kMost = 10;

 private:
  struct Programmed {
    Tag tag;
    double feed;  ///< 0: a rapid
  };
  struct Open {
    SlowPlace place;
    bool from_rest = false;                                      ///< still on the way up from it
    std::array<std::array<double, kMaxAxes + 1>, 5> by_brake{};  ///< s lost, by Brake and axis + 1
  };
  void step();
  void look(const Sample& sample);
  void open(const Programmed& in, bool from_rest);
  void close();
  void put(const Open& part);
  std::pair<Brake, int> brake(const Sample& sample) const;

  Config config_;
  Track track_;
  Planner planner_;
  Follower follower_;
  std::deque<Programmed> elements_;  ///< in motion and behind it
  std::uint64_t first_ = 0;          ///< number of the first of them
  std::uint64_t cycles_ = 0;
  bool idle_ = true;
  Vector acceleration_{};              ///< in the cycle before
  std::optional<Open> open_, before_;  ///< the place in work, and up to where the speed last rose
  double feed_ = 0.0;                  ///< in the cycle before
  std::vector<SlowPlace> places_;      ///< those that cost most first
};

}  // namespace servogate::path
