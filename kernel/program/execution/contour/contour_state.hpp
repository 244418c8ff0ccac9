// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "kernel/program/commands/canonical.hpp"
#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/geometry/circle.hpp"
#include "kernel/program/geometry/directed.hpp"

namespace servogate::program {

/// Where a word was written.
struct Place {
  int file = 0;
  int line = 0;    ///< from 1
  int column = 0;  ///< from 1
  std::int32_t block = -1;
};

/// One element of a contour as programmed, in machine coordinates.
struct ContourElement {
  bool arc = false;
  bool rapid = false;
  bool in_plane = false;  ///< its block names an axis of the plane
  Point start, end, centre;
  double sweep_deg = 0.0;
  Position to{};      ///< of all axes, as programmed
  double left = 0.0;  ///< of the tool's centre, mm, + left of the element
  bool compensated = false;
  Feed feed;
  ArcFeed feed_of = ArcFeed::tool_centre;
  CornerRule corner;
  Place place;
};

/// What stands between two elements of a contour.
struct CornerWord {
  enum class Kind : std::uint8_t { none, radius, chamfer, rolled };
  Kind kind = Kind::none;
  double value = 0.0;  ///< mm
  Place place;
};

/// Whether ways of the tool's centre that cross one another are looked for, and over how many elements: so
/// many are kept back.
struct ContourWatch {
  bool on = false;
  int elements = 4;
};

/// A command kept back while it is watched, and what of the contour it is.
struct WatchedCommand {
  Command command;
  bool element = false;
  Directed way;
  Point from, to;
  double sweep_deg = 0.0;  ///< 0: a line
};

/// The contour between the programmed path and the commands: it keeps one element back until the next one
/// tells where its end is. See Contour.
struct ContourState {
  enum class Mode : std::uint8_t { off, entering, on };
  Mode mode = Mode::off;
  double left = 0.0;  ///< distance of the tool's centre that was chosen with G41 or G42, mm
  std::optional<ContourElement> held;
  bool held_enters = false;                                   ///< it leads to the contour
  std::optional<ContourElement> before;                       ///< of a closed contour: its last element
  Point from;                                                 ///< where the tool's centre begins `held`
  std::vector<std::variant<Command, ContourElement>> behind;  ///< what comes between `held` and the next one
  CornerWord corner;
  CornerWord coming;  ///< of the block that is executed: stands behind its element
  Point shift;        ///< of the tool's centre from the programmed point where nothing is held
  Position last{};    ///< end of the last command given while engaged
  std::vector<WatchedCommand> watched;

  bool engaged() const noexcept { return mode != Mode::off || held.has_value(); }
  bool shifted() const noexcept { return shift.x != 0.0 || shift.y != 0.0; }
};

/// A profile of directed elements, in programmed coordinates; each element is kept back until its end is
/// known.
struct ProfileState {
  struct Item {
    bool point = false;
    Directed element;     ///< a circle of radius 0 is the point
    bool second = false;  ///< the joint with the next element is the second common point
    Feed feed;
    CornerRule corner;
    Position to{};  ///< machine coordinates of the axes across the plane
    Place place;
  };
  bool open = false;
  bool closed_form = false;   ///< opened by its last element
  bool begun = false;         ///< `from` is known
  std::optional<Item> first;  ///< with which it was opened
  std::optional<Item> held;
  std::optional<Item> opening;                      ///< first element of a closed one
  std::vector<std::variant<Command, Item>> behind;  ///< what comes between `held` and the next element
  Position to{};  ///< where the axes across the plane stand behind the last block
  Point from;
  CornerWord corner;
};

/// A curve through points, all of them kept back until its last direction is known.
struct SplineState {
  enum class Phase : std::uint8_t { none, entry, points, left };
  struct Knot {
    Position at{};  ///< machine coordinates
    Feed feed;
    CornerRule corner;
    Place place;
  };
  Phase phase = Phase::none;
  int ends = 0;  ///< 1: the first direction is given, 2: the last one, 3: both
  std::vector<Knot> knots;
  std::optional<Position> first;  ///< the first direction, of unit length
};

}  // namespace servogate::program
