// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <string>

#include "kernel/program/execution/capability/capability.hpp"
#include "kernel/program/execution/contour/contour.hpp"
#include "kernel/program/execution/flow/output.hpp"
#include "kernel/program/execution/frames/frames.hpp"
#include "kernel/program/execution/frames/numbers.hpp"
#include "kernel/program/geometry/circle.hpp"

namespace servogate::program {

/// Rapids, lines, arcs and helices with their feeds and corners; dwells, and the spindle's words.
class Motion {
 public:
  Motion(const Dialect& dialect, const MachineModel& machine, const Block& block, const Numbers& numbers,
         const Modes& modes, FramesState& at, MotionState& state, Frames& frames, Capability& capability,
         Output& output, Contour& contour)
      : dialect_(dialect),
        machine_(machine),
        block_(block),
        numbers_(numbers),
        modes_(modes),
        at_(at),
        state_(state),
        frames_(frames),
        capability_(capability),
        output_(output),
        contour_(contour),
        indexes_(std::any_of(machine.axes.begin(), machine.axes.end(),
                             [](const auto& axis) { return axis.index_positions > 0; })) {}

  /// The motion of a block, by the mode in force.
  void move(const BlockWords& words);
  /// Rapid to the axes of a block, but for one (-1: all).
  void position(const BlockWords& words, int without_axis);
  /// One axis to a programmed coordinate, at rapid or at the feed in force; nothing where it stands there
  /// already.
  /// `share` of that feed.
  void go(int axis, double programmed, bool rapid, double share = 1.0);
  /// Axes to programmed coordinates; those that stand there already do not move.
  void go(const Position& programmed, bool rapid);
  /// Round a programmed centre in the plane at the feed in force; `sweep_deg` + from its first axis to its
  /// second in programmed coordinates.
  void go_round(const Position& programmed, const Position& centre, double sweep_deg);
  /// To machine coordinates.
  void rapid_to(const Position& machine);
  /// One axis by the turns of the spindle.
  void tap(int axis, double programmed, double lead);
  void dwell(double seconds);
  /// Where a block leads the axes across the plane; it names no other. `from`: where they stand.
  Position across(const BlockWords& words, Position from);
  /// The feed of a block without a length of its own, and how its motion passes into the next one.
  Feed feed(const BlockWords& words) { return feed_of(words, 0.0, false); }
  CornerRule corner_of(const BlockWords& words) const;
  /// End of a block's motion in machine coordinates; the programmed coordinates are kept beside it.
  Position target_of(const BlockWords& words);
  /// A motion by the turns of the spindle.
  void thread(const Thread& thread);
  /// The same to programmed coordinates.
  void thread(const Position& programmed, double lead, double start_angle_deg);
  /// With a share of the speed in force.
  void turn_spindle(SpindleMode mode, double share = 1.0);
  /// An oriented spindle, on by an angle at the speed in force.
  void turn_spindle_by(double degrees);
  /// F, which stays in force where it is no matter of its block.
  void store_feed(const BlockWords& words);
  /// Ends a continuous profile: what follows is no feed motion.
  void end_profile() noexcept { state_.profile_open = false; }

 private:
  Position along(int axis, double programmed);
  Position along(const Position& programmed);
  void straight(const Position& to, bool rapid, double share, bool rotary);
  void add_factor(const BlockWords& words, int axis);
  void check_factors(const BlockWords& words) const;
  template <typename What>
  void give(const BlockWords& words, What&& what, const Position& to);
  void line(const BlockWords& words, const Position& to);
  void arc(const BlockWords& words, const Position& to);
  Point find_centre(const BlockWords& words, Point start, Point end, bool counter_clockwise) const;
  double helix_length(const Arc& arc, double radius) const;
  Point arc_centre(const BlockWords& words) const;
  double helix_turns(const BlockWords& words, const Position& to, double sweep_deg, double radius) const;
  Feed feed_of(const BlockWords& words, double length_mm, bool rotary_only);
  Feed programmed_feed(const BlockWords& words, double length_mm, bool rotary_only);
  bool incremental(const Value& value) const noexcept;
  bool index(const Position& to);
  double index_angle(int axis, const Value& value) const;
  bool only_indexes(const BlockWords& words) const noexcept;
  bool signs_direction(int axis) const noexcept;
  double turned_to(int axis, const Value& value, double angle) const;
  int here() const noexcept { return static_cast<int>(block_.body) + 1; }
  std::string letter(Meaning meaning) const { return std::string(1, dialect_.letter_of(meaning)); }

  const Dialect& dialect_;
  const MachineModel& machine_;
  const Block& block_;
  const Numbers& numbers_;
  const Modes& modes_;
  FramesState& at_;
  MotionState& state_;
  Frames& frames_;
  Capability& capability_;
  Output& output_;
  Contour& contour_;
  bool indexes_;  ///< the machine has an indexing axis
};

}  // namespace servogate::program
