// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/course.hpp"
#include "kernel/path/law/span.hpp"
#include "kernel/path/track/ring.hpp"

namespace servogate::path {

/// What the planner tells the follower, in order.
struct Entry {
  enum class Kind : std::uint8_t {
    span,     ///< `span`; its pieces are already in Track::pieces
    course,   ///< begins with piece span.first_piece and knot first_knot, and rests where it is complete
    extend,   ///< the last course is known as far as `extent`; pieces and knots are already in the track
    event,    ///< the path rests here; report `event` and wait for release_event()
    finish,   ///< nothing more is to be expected: rest here is no starvation
    restart,  ///< the path goes on at `at` with piece span.first_piece; ends the dropping after a stop
  };
  Kind kind = Kind::span;
  std::uint32_t event = 0;
  Tag tag;  ///< of a marker
  Span span;
  std::uint64_t first_knot = 0, first_stop = 0;  ///< numbers in Track::knots and Track::stops
  CourseExtent extent;
  double planned = 0.0;  ///< s, running sum of what is known for certain then
  Vector at{};
};

/// The one connection of planner and follower. The cycle reads entries.written() once per cycle, records it,
/// and gives it to the follower: a replay that gives the same numbers gives the same set-points.
struct Track {
  explicit Track(const Config& config)
      : pieces(config.piece_capacity < 1024 ? 1024 : config.piece_capacity, kPassed),
        knots(kKnots),
        stops(kKnots),
        entries(2 * pieces.capacity()) {}
  static constexpr std::uint32_t kPassed = 64;  ///< pieces that stay readable behind the motion: of one cycle
  static constexpr std::uint32_t kKnots = 8192;  ///< half a minute on a usual machine, a megabyte
  /// Where the entries of a path begin: numbers of its restart entry, of its first piece, knot and stop.
  struct Begin {
    std::uint64_t entry = 0, piece = 0, knot = 0, stop = 0;
  };
  Ring<Piece> pieces;
  Ring<Knot> knots;
  Ring<StopHint> stops;
  Ring<Entry> entries;
  /// Writer: see Ring::hold().
  void hold() noexcept {
    pieces.hold();
    knots.hold();
    stops.hold();
    entries.hold();
  }
  void let_go() noexcept {
    pieces.let_go();
    knots.let_go();
    stops.let_go();
    entries.let_go();
  }
  /// Count for Follower::step(). real-time safe.
  std::uint64_t visible() const noexcept { return entries.written(); }
};

}  // namespace servogate::path
