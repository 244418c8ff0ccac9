// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/program/execution/frames/frames.hpp"
#include "kernel/program/execution/state/virtual_axes.hpp"

namespace servogate::program {

/// No virtual axes are in force; no block may name one.
VirtualAxes no_virtual_axes(const MachineModel& machine);
/// The same from here on; what the machine does not have stands at 0.
void end_virtual_axes(const MachineModel& machine, VirtualAxes& axes, Position& at);

/// Leads the followers of virtual axes along the commands of a block: a motion becomes chords in coordinates
/// of the machine, which leave the programmed path by at most half a micrometre, with the speed along that
/// path. Throws ProgramError where the machine cannot follow. Not for the cycle.
class Followers {
 public:
  /// `line`, `column`: of the block, from 1.
  Followers(const MachineModel& machine, const Frames& frames, FramesState& at, VirtualAxes& axes, int line,
            int column)
      : machine_(machine), frames_(frames), at_(at), axes_(axes), line_(line), column_(column) {}

  void lead(std::vector<Command>& commands);

 private:
  /// A straight or circular way of the axes that a program moves.
  struct Way {
    Position from, to;
    const Arc* arc = nullptr;  ///< in the plane of its axes; all others go linearly with the angle
    double length = 0.0;
    Position place(double share) const;
  };
  struct Chord {
    double until;  ///< share of the way
    Position end;
  };

  bool take(const Command& command, std::vector<Command>& out);
  void rapid(const Command& command, const Rapid& rapid, std::vector<Command>& out);
  template <typename What>
  void feed(const Command& command, const What& what, const Arc* arc, std::vector<Command>& out);
  Position followed(const Position& place, const Position& before) const;
  double beside(const Position& chord, const Position& place) const;
  void divide(const Way& way, double from, const Position& begin, double to, const Position& end, int depth,
              std::vector<Chord>& out) const;
  std::vector<Chord> chords(const Way& way) const;
  double length_of(const Way& way) const;
  double nearest(const Way& way) const;
  void check_radius(double nearest) const;
  Feed feed_of(const Feed& programmed, double share, double length) const;
  void check_travel(const Position& to) const;
  Position given(Position to) const;
  bool follows(int axis) const;

  const MachineModel& machine_;
  const Frames& frames_;
  FramesState& at_;
  VirtualAxes& axes_;
  int line_, column_;
};

}  // namespace servogate::program
