// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "kernel/path/path_time.hpp"

namespace servogate::path {

/// A part of a path where it is slower than programmed.
struct SlowPlace {
  Tag first, last;       ///< elements where it begins and ends
  int times = 1;         ///< that the path passes them so
  double seconds = 0.0;  ///< that it takes, all times together
  double lost = 0.0;     ///< of these: what the same way would not take at the programmed feed
  double slowest = 0.0;  ///< mm/s
  double feed = 0.0;     ///< programmed where it is slowest, mm/s
  Brake brake = Brake::shape;
  int axis = -1;  ///< path axis of a limit
};

/// Finds where a path is slow as the machine drives it at 100 %, and why: what takes most of the time there.
/// It is foretold and not driven (PathTime). Rapids are as fast as the limits, and are not looked at.
/// In-position waiting is not counted. Memory is bounded. Not real-time safe.
class Survey final : private MomentSink {
 public:
  Survey(const Config& config, const Vector& start);

  /// Appends an element; its tag comes back in the places. False: it cannot be driven, last_flaw() says why,
  /// and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return time_.last_flaw(); }
  /// The path comes to rest behind the elements added so far.
  void rest();
  /// PathTime::seconds().
  double seconds() const { return time_.seconds(); }
  /// The places that cost most, those first, at most kMost.
  std::vector<SlowPlace> slowest() const;
  static constexpr std::size_t kMost = 10;

 private:
  struct Programmed {
    Tag tag;
    double feed;  ///< 0: a rapid
    double revolutions;
  };
  struct Open {
    SlowPlace place;
    bool from_rest = false;                                      ///< still on the way up from it
    std::array<std::array<double, kMaxAxes + 1>, 5> by_brake{};  ///< s lost, by Brake and axis + 1
  };
  void put(const Moment& moment) override;
  void open(const Programmed& in, bool from_rest);
  void close();
  void keep(const Open& part);

  PathTime time_;
  std::deque<Programmed> elements_;    ///< in motion and behind it
  std::uint64_t first_ = 0;            ///< number of the first of them
  std::optional<Open> open_, before_;  ///< the place in work, and up to where the speed last rose
  double feed_ = 0.0;                  ///< in the moment before
  std::vector<SlowPlace> places_;      ///< those that cost most first
};

}  // namespace servogate::path
