// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/path/bound/bound.hpp"

namespace servogate::path {

/// What the law outside the cycle tells the law inside about a span; nobody else looks into it. Today: how
/// fast it may be driven, and with what speed it may be left, without acceleration.
struct Terms {
  Box box;
  Feed feed;
  double exit_limit = 0.0;    ///< largest speed at the end from which all that follows can be driven
  double exit_nominal = 0.0;  ///< the same if everything that follows is driven at override 1 at most
};

/// A stretch of pieces that the law treats as one.
struct Span {
  std::uint64_t number = 0;       ///< running
  std::uint64_t first_piece = 0;  ///< number in Track::pieces
  std::uint32_t pieces = 0;
  bool stop = false;     ///< the path rests at the end (exact stop, event, end)
  bool confirm = false;  ///< and goes on after Follower::release_stop()
  bool final = false;    ///< terms will not be revised any more
  double length = 0.0;
  double time = 0.0;  ///< running sum of the shortest times up to the end, s
  Terms terms;
};

/// Where the law outside the cycle puts what it has decided, in order.
class SpanSink {
 public:
  virtual void put(const Piece& piece) = 0;
  /// A span whose pieces have been put; `revised`: one that was put before has new terms. `more`: the next
  /// one belongs with it, neither may be used before both are seen.
  virtual void put(const Span& span, bool revised, bool more) = 0;

 protected:
  ~SpanSink() = default;
};

/// The spans that the cycle knows, from the one in motion on.
class Ahead {
 public:
  /// The n-th, from 0; nullptr where the path is not known or something else stands between. real-time safe.
  virtual const Span* span(int n) const noexcept = 0;

 protected:
  ~Ahead() = default;
};

}  // namespace servogate::path
