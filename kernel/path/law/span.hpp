// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/path/bound/bound.hpp"

namespace servogate::path {

/// A stretch of pieces that the law treats as one: an element from rest to rest, or a part of a chain of
/// threads. What is published is final.
struct Span {
  std::uint64_t number = 0;       ///< running
  std::uint64_t first_piece = 0;  ///< number in Track::pieces
  std::uint32_t pieces = 0;
  bool stop = false;     ///< the path rests at the end; only in a chain of threads it need not
  bool confirm = false;  ///< and goes on after Follower::release_stop()
  double length = 0.0;
  double time = 0.0;  ///< running sum of the shortest times up to the end, s
  Bound terms;        ///< the least of its pieces; nobody outside of the law looks into it
};

/// Where the law outside the cycle puts what it has decided, in order.
class SpanSink {
 public:
  virtual void put(const Piece& piece) = 0;
  /// A span whose pieces have been put.
  virtual void put(const Span& span) = 0;

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
