// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// The quintic that joins two points with first and second derivative over a parameter length.
Piece quintic(const PathPoint& from, const PathPoint& to, double length, int axes);

/// Rounds a run of short lines as a whole, where the lines are too short for a corner to use its tolerance:
/// quintics over several lines each, through points of a moving average of the programmed path (position,
/// tangent and curvature by a biweight kernel), so that the curvature changes over the length that the
/// tolerance allows and not over one block. The run begins in the middle of its first line and ends in the
/// middle of its last one, tangent to both and without curvature. What comes out depends on the sequence of
/// lines only. Not real-time safe.
class Smoothing {
 public:
  explicit Smoothing(int axes) : axes_(axes) {}

  /// True when the corner between two lines can be part of a run: turned by less than 30 degrees, and rounded
  /// from middle to middle within the tolerance.
  static bool suits(const Piece& before, const Piece& after, double tolerance, int axes);

  bool empty() const { return lines_.empty(); }
  /// Begins a run with its first line.
  void begin(const Piece& line, double tolerance);
  /// Appends a line that suits the one before.
  void append(const Piece& line);
  /// One slice of the result: the part that lies along one line, with the line's tag.
  struct Slice {
    Piece piece;
    std::size_t line;  ///< running number of the line within the run, from 0
  };
  /// Appends what is decided so far to `out`; with `end` everything up to the middle of the last line, and
  /// the run is empty afterwards.
  void take(bool end, std::vector<Slice>& out);

 private:
  struct Line {
    Piece piece;
    double start;  ///< parameter within the run
    double middle() const { return start + 0.5 * piece.length; }
  };
  struct Node {
    std::size_t line = 0;  ///< the node is at the middle of this line
    PathPoint point;
  };
  PathPoint average(std::size_t line, double width) const;
  bool near(const Piece& piece, std::size_t line, double begin, double s) const;
  bool fits(const Piece& piece, std::size_t from, std::size_t to) const;
  bool reach(std::size_t line, bool end, Node& found, Piece& piece) const;
  void slice(const Piece& piece, std::size_t from, std::size_t to, std::vector<Slice>& out) const;
  Vector programmed(std::size_t line, double s) const;
  void forget();

  int axes_;
  double tolerance_ = 0.0;
  std::vector<Line> lines_;
  std::size_t forgotten_ = 0;  ///< lines before lines_[0]
  Node node_;                  ///< end of what was taken
  std::size_t stride_ = 4;     ///< lines that the last piece spanned
};

}  // namespace servogate::path
