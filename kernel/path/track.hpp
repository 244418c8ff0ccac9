// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include "kernel/path/geometry/piece.hpp"

namespace servogate::path {

/// A bounded queue from one writer to one reader, wait-free on both sides, whose slots are read in place.
/// Positions are running numbers that never wrap. Construction allocates, nothing else does.
template <typename T>
class Ring {
 public:
  explicit Ring(std::uint32_t capacity) : slots_(capacity) {}

  /// Writer: number of slots written so far. Also what a reader may see. real-time safe.
  std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }
  /// Number of slots given back so far. real-time safe.
  std::uint64_t freed() const noexcept { return freed_.load(std::memory_order_acquire); }
  std::uint32_t capacity() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }

  /// Writer: false when the ring is full. real-time safe.
  bool push(const T& value) noexcept {
    const std::uint64_t at = written_.load(std::memory_order_relaxed);
    if (at - freed() >= capacity()) return false;
    slots_[at % capacity()] = value;
    written_.store(at + 1, std::memory_order_release);
    return true;
  }
  /// Reader: a slot with freed() <= number < written(). real-time safe.
  const T& operator[](std::uint64_t number) const noexcept { return slots_[number % capacity()]; }
  /// Reader: gives back all slots below `number`. real-time safe.
  void free_below(std::uint64_t number) noexcept { freed_.store(number, std::memory_order_release); }

 private:
  std::vector<T> slots_;
  std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint64_t> freed_{0};
};

/// A stretch of pieces that is driven with one box and one S-curve; acceleration is 0 at its ends.
struct Span {
  std::uint64_t number = 0;       ///< running
  std::uint64_t first_piece = 0;  ///< number in Track::pieces
  std::uint32_t pieces = 0;
  bool stop = false;     ///< the path rests at the end (exact stop, event, end)
  bool confirm = false;  ///< and goes on after Follower::release_stop()
  bool final = false;    ///< exit speeds will not be raised any more
  double length = 0.0;
  double time = 0.0;  ///< running sum of the shortest times up to the end, s
  Box box;
  double feed = 0.0;          ///< parameter speed at override 1
  double per_turn = 0.0;      ///< the same in one revolution of the spindle, 0: feed per time
  double turns = 0.0;         ///< revolutions a second that `feed` is planned for
  double exit_limit = 0.0;    ///< largest speed at the end from which all that follows can be driven
  double exit_nominal = 0.0;  ///< the same if everything that follows is driven at override 1 at most
};

/// What the planner tells the follower, in order.
struct Entry {
  enum class Kind : std::uint8_t {
    span,     ///< `span`; its pieces are already in Track::pieces
    raise,    ///< span.number: its exit speeds are final and rise to span.exit_limit, span.exit_nominal
    event,    ///< the path rests here; report `event` and wait for release_event()
    finish,   ///< nothing more is to be expected: rest here is no starvation
    restart,  ///< the path goes on at `at`; ends the dropping after a stop
  };
  Kind kind = Kind::span;
  bool more = false;  ///< the next entry belongs with this one: neither may be used before both are seen
  std::uint32_t event = 0;
  Tag tag;
  Span span;
  Vector at{};
};

/// The one connection of planner and follower. The cycle reads entries.written() once per cycle, records it,
/// and gives it to the follower: a replay that gives the same numbers gives the same set-points.
struct Track {
  explicit Track(const Config& config)
      : pieces(config.piece_capacity < 1024 ? 1024 : config.piece_capacity), entries(2 * pieces.capacity()) {}
  /// Where the entries of a path begin: numbers of its restart entry and of its first piece.
  struct Begin {
    std::uint64_t entry = 0, piece = 0;
  };
  Ring<Piece> pieces;
  Ring<Entry> entries;
  /// Count for Follower::step(). real-time safe.
  std::uint64_t visible() const noexcept { return entries.written(); }
};

}  // namespace servogate::path
