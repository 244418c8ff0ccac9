// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kernel/path/law/span.hpp"

namespace servogate::path {

/// The law of spans outside the cycle: takes pieces with what each allows, and gives spans with the terms on
/// which they are driven: one piece from rest to rest, or the pieces of a chain of threads, those that allow
/// about the same in one span. The last span is kept until it is known whether another follows. What it gives
/// depends on the sequence of calls alone. Not real-time safe.
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
  Open open_;
  std::vector<Piece> pieces_;  ///< of the open span
  std::uint64_t next_piece_ = 0;
  double time_ = 0.0;         ///< running sum over the pieces
  std::uint64_t number_ = 0;  ///< of the last span
  std::optional<Span> last_;  ///< not put yet
};

}  // namespace servogate::path
