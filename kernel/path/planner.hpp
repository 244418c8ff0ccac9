// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kernel/path/law/moment.hpp"
#include "kernel/path/track/track.hpp"

namespace servogate::path {

/// Turns programmed elements into geometry and speeds that can be driven, outside the cycle: makes
/// courses of what goes on without a rest, bounds the rest piece by piece. One per process; one thread calls
/// it. What it publishes depends on the sequence of calls of add, add_event, finish and restart only, never
/// on when they are made. Not real-time safe.
class Planner {
 public:
  /// All positions are path coordinates, see Config::transformation. `forecast`: courses are foretold there,
  /// have no pieces, knots and stops, and cannot be followed (CourseForecast).
  Planner(const Config& config, Track& track, MomentSink* forecast = nullptr);
  ~Planner();
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  /// Forgets what is not yet handed to the track and goes on at `at`, where the follower stands at rest.
  /// First call of every program, and the way on after Follower::stop(). Gives the place in the track where
  /// the new path begins; nothing of it is published before the next work().
  Track::Begin restart(const Vector& at);

  /// Appends an element. False: it cannot be driven, last_flaw() says why, and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const;
  /// The element inside of which the path comes to rest although its program does not ask for it, the newest
  /// one since the last call: no law of a course inside of the limits was found for what comes next, and
  /// some elements behind that place are driven from rest to rest. May be known long after the element was
  /// added, and is known for certain behind rest() and work().
  std::optional<Tag> take_unasked_rest();

  /// A mark in the end point of the elements before, which the motion passes without a rest: the follower
  /// counts it in Sample::passed. The corner may be rounded there; its middle counts. Where the path stops,
  /// it is passed when the path goes on.
  void add_mark();

  /// The path comes to rest after the elements before, as at an event.
  void rest();

  /// The path comes to rest after the elements before; the follower reports the event and waits there until
  /// Follower::release_event().
  void add_event(std::uint32_t id, const Tag& tag);

  /// Nothing more for now: what was added runs to rest at its end. add() may go on later.
  void finish();

  /// False while enough is planned ahead (five seconds behind the stretch in motion, or as much as the track
  /// holds): call add() when true. add() works all the same when false; it only costs memory.
  bool wants_more() const;

  /// Plans what can be planned, and publishes what has room in the track. Call it after add() and regularly
  /// while wants_more() is false.
  void work();

  /// As work(), but plans one window of it at most: a second of motion, about. True: there may be more to
  /// plan now. What is published in the end is the same.
  bool work_a_little();

  /// The path has got a rest that is not planned yet; what was added behind it waits. It is planned by
  /// work(), and needs nothing else.
  bool ends() const;

  /// Something waits for room in the track, or behind a rest that is not planned yet.
  bool waits() const;
  /// For how long what is in the track moves at an override of 100 %, s; 0: not at all, or it is not known.
  /// `driven`: Follower::driven().
  double ahead(std::optional<double> driven) const;
  /// Sum of the times of all that is final, s; it only grows.
  double planned() const;

  /// End of the elements added so far.
  const Vector& position() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What a list of elements will do, found by planning and following it at once.
struct Estimate {
  double seconds = 0.0;
  std::int64_t cycles = 0;
  Vector lowest{}, highest{};  ///< extents of the set-points, start included
  std::size_t flawed = 0;      ///< index + 1 of the first element that cannot be driven, 0: none
  Flaw flaw = Flaw::none;
};

/// Time at a constant feed override and extents of a program from `start`. No in-position waiting is counted.
/// Not real-time safe.
Estimate estimate(const Config& config, const Vector& start, std::span<const Element> elements,
                  double override_ratio = 1.0);

}  // namespace servogate::path
