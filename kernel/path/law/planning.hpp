// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <vector>

#include "kernel/path/law/lookahead.hpp"

namespace servogate::path {

/// The law outside the cycle: takes the pieces of a contour with what each allows, and gives spans with the
/// terms on which they are driven. What it gives depends on the sequence of calls alone. Not real-time safe.
class Planning {
 public:
  /// `capacity`: of the track, in pieces.
  Planning(const Config& config, std::uint32_t capacity, SpanSink& sink);

  /// Appends a piece.
  void append(const Piece& piece, const Bound& bound);
  /// The path rests behind what was appended.
  void rest(bool confirm);
  /// Forgets what was not put yet; the path goes on from rest.
  void restart();
  /// Pieces and times of another law lie before what is appended next.
  void begin_at(std::uint64_t piece, double planned) {
    next_piece_ = piece;
    time_ = planned;
  }
  /// Number of the last span; markers carry it.
  std::uint64_t last_number() const { return lookahead_.last_number(); }

 private:
  /// Sum of pieces that become one span.
  struct Open {
    double length = 0.0, time = 0.0;
    Bound least{{kInfinity, kInfinity, kInfinity}, {kInfinity}};
  };
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bool belongs(const Piece& piece, const Bound& bound, double own_time) const;
  void close();

  Config config_;
  std::size_t most_pieces_;  ///< in a span
  SpanSink& sink_;
  Lookahead lookahead_;
  Open open_;
  std::vector<Piece> pieces_;  ///< of the open span
  std::uint64_t next_piece_ = 0;
  double time_ = 0.0;  ///< running sum over the pieces
};

}  // namespace servogate::path
