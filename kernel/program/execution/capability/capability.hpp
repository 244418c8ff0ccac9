// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/execution/flow/flow.hpp"
#include "kernel/program/execution/state/block_words.hpp"
#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/execution/state/state.hpp"
#include "kernel/program/faults/texts.hpp"

namespace servogate::program {

class Reach;

/// What has been told so far of what the control does otherwise.
struct Warnings {
  std::vector<text::Finding> told;
  bool standing_told = false;  ///< that the spindle stands
};

/// What the machine can do of what a program asks for. What it cannot do at all is an error; what the control
/// limits, as the old one did, is a warning at the word that asks for it: `check`, `canon`, `run`, `up` and
/// MDI all say it from here.
class Capability {
 public:
  Capability(const Dialect& dialect, const MachineModel& machine, const Block& block, const Flow& flow,
             const Modes& modes, const FramesState& frames, MotionState& motion, Warnings& warnings);

  /// A column of the block that is executed.
  Written written(int column) const noexcept;
  /// Tells of a place once.
  void warn(Written& place, const text::Entry& kind, std::vector<std::string> arguments);
  void warn(Written& place, Fault fault, std::vector<std::string> arguments) {
    warn(place, entry(fault), std::move(arguments));
  }

  /// A T word: the place in the magazine, the corrector in the table.
  void check_tool(int column);
  /// M3 and its like say that the spindle turns; the speed has to stand before them or in their block.
  void check_start(const Word& word);
  /// The speed with which the spindle is to turn from here on; `word` asks for it.
  void check_speed(const Word& word);
  /// The feed of a motion from where the machine stands.
  void check_line(const BlockWords& words, const Line& line);
  void check_arc(const BlockWords& words, const Arc& arc, double radius, double length);

  /// Speed of the spindle along the way to `to`, the largest where it changes; 0: not known.
  double spindle_rpm(const Position& to) const;
  /// More than all axes together reach, mm/s and degrees/s; 0: not known.
  double all_rapids() const noexcept { return all_rapids_; }
  /// Whose coordinate is the radius for G96, -1: there is none.
  int surface_axis() const noexcept { return surface_axis_; }

 private:
  void check_turning(const Feed& feed);
  double path_speed(const Feed& feed, double length, const Position& to) const;
  void check_feed(const BlockWords& words, double speed, const Reach& reach, bool linear);

  const Dialect& dialect_;
  const MachineModel& machine_;
  const Block& block_;
  const Flow& flow_;
  const Modes& modes_;
  const FramesState& frames_;
  MotionState& motion_;
  Warnings& warnings_;
  double every_rapid_;  ///< speed that every axis reaches, mm/s and degrees/s
  double all_rapids_ = 0.0;
  int surface_axis_ = -1;
};

}  // namespace servogate::program
