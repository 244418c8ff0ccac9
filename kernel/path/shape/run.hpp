// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "kernel/path/shape/kept.hpp"
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// An element of a run: the programmed geometry as it is, and what the program wants of it.
struct Leg {
  Piece piece;             ///< a line or an arc, length > 0
  double begin = 0.0;      ///< path parameter at its start, from the start of the run
  double tolerance = 0.0;  ///< largest distance of the set-points from it, > 0
  bool exact = false;      ///< and 1.5 um at most, as no corner needs more
  double feed = std::numeric_limits<double>::infinity();  ///< as Element::feed
  double revolutions = 0.0;  ///< as Element::revolutions; the most where `surface` changes it
  Surface surface;
  double corner =
      std::numeric_limits<double>::infinity();  ///< largest speed where it starts, by a corner rule
  std::uint32_t axes = 0;  ///< bits of the axes that it moves through a transformation; 0: its coordinates
  const std::array<AxisLimits, kMaxAxes>* limits = nullptr;  ///< of the axes, while it is driven
  double end() const { return begin + piece.length; }
};

inline bool moves(const Piece& p, std::size_t coordinate) {
  return p.c1[coordinate] != 0.0 ||
         (p.shape == Piece::Shape::arc && (p.axis1 == coordinate || p.axis2 == coordinate));
}
/// An axis that the leg moves.
inline bool moves(const Leg& leg, std::size_t axis) {
  return leg.axes != 0 ? (leg.axes >> axis & 1u) != 0 : moves(leg.piece, axis);
}
/// Bits of the axes that a piece moves; 0: the identity, its coordinates.
std::uint32_t axes_moved(const Config& config, const Piece& piece);

/// Revolutions a second that the leg is planned for at its place `x`, path parameter `u`; 0: feed per time.
inline double turns_at(const Leg& leg, const Vector& x, double u) {
  return leg.surface.speed > 0.0 ? turns_at(leg.surface, x, leg.piece.offset + u - leg.begin)
                                 : leg.revolutions;
}
/// Feed there.
inline double feed_at(const Leg& leg, const Vector& x, double u) {
  return leg.surface.speed > 0.0 ? leg.feed * turns_at(leg, x, u) / leg.revolutions : leg.feed;
}

/// No speed of the parameter is higher than this, mm/s or degrees/s.
double fastest(const Leg& leg, int axes);

/// The programmed path from rest to rest as a function of one parameter u, which is the length over all its
/// legs. Only legs that are still needed are kept. Not real-time safe.
class Run {
 public:
  explicit Run(int axes) : axes_(axes) {}

  /// A new run, that begins at `speed`; 0: from rest.
  void clear(double speed = 0.0) {
    legs_.clear();
    begin_speed_ = speed;
    end_speed_ = 0.0;
  }
  /// Of the parameter at its begin and its end, where it flies in from and out to a straight line; 0: rest.
  double begin_speed() const { return begin_speed_; }
  double end_speed() const { return end_speed_; }
  void end_at(double speed) { end_speed_ = speed; }
  /// Appends a leg that starts where the last one ends; `begin` is filled here.
  void append(Leg leg);
  /// Legs that end at or before `u` may go.
  void forget_before(double u);
  bool empty() const { return legs_.empty(); }
  double length() const { return legs_.empty() ? 0.0 : legs_.back().end(); }
  int axes() const { return axes_; }

  std::size_t first() const { return legs_.begin(); }
  std::size_t end() const { return legs_.end(); }
  const Leg& leg(std::size_t n) const { return legs_[n]; }
  /// Number of the leg that u lies on, the later one where two meet. `near` is a number to begin at.
  std::size_t leg_at(double u, std::size_t near) const;
  Vector at(double u, std::size_t near) const;
  /// Place near `u`, by at most `reach`, that is reached from it along the path while it comes closer to `x`:
  /// so the other leg of a fold is not found.
  double downhill(const Vector& x, double u, double reach, std::size_t near) const;
  /// Largest distance at u on leg `n`: the tolerance near the ends of the leg, no more than 1.5 um away from
  /// them.
  double radius(double u, std::size_t n) const;

 private:
  double foot(const Vector& x, const Leg& leg, double u) const;
  int axes_;
  double begin_speed_ = 0.0, end_speed_ = 0.0;
  Kept<Leg> legs_;
};

}  // namespace servogate::path
