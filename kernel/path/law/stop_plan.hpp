// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/rate.hpp"

namespace servogate::path {

/// A stop by a rate whose second derivative, the bend, is constant from piece to piece: equal pieces, and a
/// last one in which rate and slope come to 0 together. Everything here is real-time safe.
class StopPlan {
 public:
  static constexpr std::size_t kMostPieces = 256;  ///< and the last one
  double r0 = 1.0, slope0 = 0.0, seconds = 0.0;
  static constexpr double r1 = 0.0;
  /// `t` seconds from its start, >= 0; behind `seconds` it rests.
  RateState at(double t) const noexcept;

  /// No pieces yet: it begins with this rate and slope, and its pieces take `piece` seconds, > 0.
  void begin(double rate, double slope, double piece) noexcept;
  /// A piece with this second derivative; at most kMostPieces.
  void add(double bend) noexcept;
  /// The last piece, from a rate that falls in size.
  void close() noexcept;

 private:
  std::array<RateState, kMostPieces + 2> at_{};  // where the pieces begin, each with the bend of its piece
  std::size_t count_ = 0;
  double piece_ = 0.002;
};

}  // namespace servogate::path
