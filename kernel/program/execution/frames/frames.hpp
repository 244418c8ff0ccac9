// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/execution/state/state.hpp"
#include "kernel/program/reading/block.hpp"

namespace servogate::program {

/// Planes, origins, tool lengths, and how far the axes may go.
class Frames {
 public:
  Frames(const Dialect& dialect, const MachineModel& machine, const AxisLetters& axes, FramesState& state)
      : dialect_(dialect), machine_(machine), axes_(axes), state_(state) {}

  /// Origin, mirror, rotation, scale, plane and field as after power-on; tool lengths stay.
  void reset();
  /// After a change of the frame: the machine stands still, its programmed coordinates are new.
  void changed();
  /// The axes stand at `at` now, whoever moved them.
  void reposition(const Position& at);
  /// Takes over tables that somebody else changed; origins in force move with their rows.
  void adopt(Tables tables);
  /// Changes the origin in force of an axis so that the present position is `value`, in the table too.
  void preset(int axis, double value);
  /// A row of the origins for all axes; what it does not name, and row 0 where there is none, is machine
  /// zero.
  void use_origin(int number, int column);
  /// What the tool in force takes from the path at its side, wear included, mm.
  double tool_radius() const;
  /// The lengths of a row of the tool table come into force; 0: none.
  void use_lengths(int row);

  /// `required`: a program asks for it at `column`. At power-on a machine may lack an axis of it.
  void select_plane(Function plane, bool required, int column);
  void set_plane(int axis1, int axis2, int normal);
  /// Throws where the machine lacks an axis of the plane in force, as at power-on: what needs a plane (arcs,
  /// rotation, cycles) has none then.
  void need_plane(int column) const;
  /// Travel and working field. Source: specification A 23 (checked before the motion starts), B 6.3.
  void check_axis(int axis, double value, int column) const;
  /// Throws where a straight way or an arc passes through an active protected zone. Source: specification
  /// B 6.5.
  void check_zones(const Position& from, const Position& to, int column) const;
  void check_zones(const Position& from, const Arc& arc, int column) const;

 private:
  [[noreturn]] void refuse_plane(Function plane, int column) const;

  const Dialect& dialect_;
  const MachineModel& machine_;
  const AxisLetters& axes_;
  FramesState& state_;
};

}  // namespace servogate::program
