// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/program/commands/canonical.hpp"
#include "kernel/program/execution/contour/contour_state.hpp"
#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/execution/state/virtual_axes.hpp"
#include "kernel/program/geometry/elements.hpp"
#include "kernel/program/geometry/frame.hpp"
#include "kernel/program/reading/dialect.hpp"
#include "kernel/program/values/parameters.hpp"

namespace servogate::program {

/// Modal functions in force.
struct Modes {
  Function motion = Function::rapid;
  Function corner = Function::corner_limited;
  Function unit = Function::metric;
  Function dimension = Function::absolute;
  Function feed = Function::feed_minute;
  Function spindle = Function::revolutions;
  Function across = Function::diameter;  ///< how words of a diameter axis count
  Function compensation = Function::compensation_off;
  Function profile = Function::profile_off;
  double speed = 0.0;    ///< S in rpm or, if `cutting`, m/min
  bool cutting = false;  ///< what `speed` is, G96 or G97 of the block that set it
  bool override_effective = true;
};

/// Where the program stands, and what it has to come back to.
struct FlowState {
  struct Call {
    int file = 0;
    std::uint32_t back = 0;   ///< line at which the caller goes on
    std::size_t loops = 0;    ///< repeats open in the caller
    std::uint32_t first = 0;  ///< line at which the called program begins
    int left = 1;             ///< how often it still runs, this time counted
    std::vector<double> arguments = {};
  };
  struct Loop {
    std::size_t depth;  ///< number of calls at the repeat
    std::uint32_t first;
    std::uint32_t last;
    int left;
  };
  struct Part {
    std::size_t depth;
    std::uint32_t first;
    std::uint32_t last;
    std::uint32_t back;
    std::size_t loops;
  };
  /// Lines that a cycle works by their numbers; passing over them does not execute them.
  struct Contour {
    int file;
    std::uint32_t first;
    std::uint32_t last;
  };
  int file = 0;
  std::uint32_t line = 0;  ///< next line to read
  std::vector<Call> calls;
  std::vector<Loop> loops;
  std::optional<Part> part;
  std::vector<Contour> contours;
  bool barrier = false;    ///< the next block is read only after the motion before it
  bool went_back = false;  ///< a jump has led back since the block began
};

/// Where a modal word was written that the control may have to speak of later.
struct Written {
  int file = 0;
  int line = 0;  ///< 0: nowhere, it is a power-on value
  int column = 0;
  bool told = false;  ///< its warning has been given
};

/// A canned cycle in force, in terms of the machine (cycles/). Lengths in programmed coordinates, mm.
struct Cycle {
  std::string name;           ///< as the language writes it; empty: none is in force
  int axis = 2;               ///< along which it works
  double approach = 0.0;      ///< down to here at rapid ...
  double depth = 0.0;         ///< ... and to here at the feed in force
  double retreat = 0.0;       ///< back to here
  bool back_at_feed = false;  ///< up to `approach`, from there at rapid
  double step = 0.0;          ///< first one of a deep hole, 0: it is made in one
  double factor = 0.0;        ///< of a step to the one before, 0: chips are broken, not removed
  double min_step = 0.0;
  double lead = 0.0;        ///< of a thread that is cut by the turns of the spindle, 0: at the feed in force
  double back_share = 1.0;  ///< of the speed on the way back from a thread
  double clearance = 0.0;   ///< above the last bottom at which removing chips comes back
  bool dwells = false;      ///< at the bottom of each step ...
  double dwell_s = 0.0;     ///< ... so long, as the language counts it at this hole
  enum class Spindle : std::uint8_t { turns, reverses, stops };
  Spindle at_bottom = Spindle::turns;  ///< reversed until back at `approach`, stopped until the next hole
  Written levels_at;                   ///< the word that gave the levels in force
  bool spindle_rests = false;  ///< stopped at the bottom of a hole, to start again before the next one
};

/// A field of two axes that no motion enters while it is active; machine coordinates without the tool length.
struct ProtectedZone {
  bool defined = false, active = false;
  std::array<int, 2> axis{};
  std::array<double, 2> low{}, high{};
};

/// Coordinates, the frame that leads between them, and the tables behind it.
struct FramesState {
  Frame frame;
  Position programmed{};                               ///< end of the last motion in programmed coordinates
  Position machine{};                                  ///< the same in machine coordinates
  std::array<std::int16_t, image::kMaxAxes> origin{};  ///< number of the origin in force, of each axis
  Position field_min{}, field_max{};                   ///< machine coordinates without the tool length
  Function plane = Function::plane_12;                 ///< as selected last by a G word
  int axis1 = -1;                                      ///< abscissa and ordinate, -1: the machine lacks it
  int axis2 = -1;
  int normal = -1;        ///< axis across the plane, -1: none
  std::int32_t tool = 0;  ///< last T word
  std::int32_t corrector = 0;
  std::int32_t active_corrector = 0;  ///< whose lengths and radius are in force
  bool lengths_off = false;           ///< those of no corrector, until the program says otherwise
  bool lengths_by_language = false;   ///< a tool change leaves the lengths alone: words of their own set them
  std::int32_t radius_row = -1;       ///< whose radius is in force, -1: that of `active_corrector`
  std::shared_ptr<const Tables> tables;
  std::array<ProtectedZone, 3> zones{};
  bool zones_active = false;
};

/// F as programmed.
struct ProgrammedFeed {
  double feed = 0.0;  ///< 0: never
  bool feed_inch = false;
  Function feed_unit = Function::feed_minute;  ///< the mode in which it was written
  Written feed_at;
};

/// What motion goes by beside the modes.
struct MotionState : ProgrammedFeed {
  bool feed_metric = false;  ///< an inch mode in force is one of lengths only
  bool speed_told = true;    ///< the machine knows the speed of `modes`
  Written speed_at;
  SpindleMode spindle = SpindleMode::stop;
  double limit_rpm = 0.0;  ///< of a cutting speed, 0: none
  double dwell = 0.0;      ///< set by a variable, s or revolutions
  double corner_error_mm = 0.0;
  double max_angle_deg = 0.0;  ///< a sharper corner stops
  double allowance = 0.0;      ///< mm
  bool dry_run = false;        ///< feed motions at rapid speed
  ArcFeed arc_feed = ArcFeed::tool_centre;
  ContourWatch watch;
  bool coupled = false;             ///< the second spindle follows the first one
  bool spindle_is_axis = false;     ///< the first spindle is its rotary axis ...
  double spindle_axis_place = 0.0;  ///< ... which stands here while it is none; machine coordinate
  bool profile_open = false;        ///< inside of a running chain of feed blocks without a stop
  Cycle cycle;
};

/// Everything of an interpreter that changes while a program runs; a plain value.
class Execution;

/// What the touches of the block under way are for. The values of a part without any error are in force until
/// they are there.
struct ProbingState {
  void (*take)(Execution& run) = nullptr;  ///< of the language: results from touches; nullptr: none is due
  std::size_t expected = 0;
  std::vector<Position> touches;  ///< machine coordinates of the axes, in the order of the probes
  Position nominal{};             ///< programmed coordinates
  std::array<int, 3> axes{};      ///< whose results are wanted
  std::size_t count = 0;
  int first = 0;  ///< parameter that takes the first result
  int column = 0;
  bool deviations = false;
};

struct State {
  Modes modes;
  Parameters parameters;
  FlowState flow;
  FramesState frames;
  MotionState motion;
  ContourState contour;
  ProfileState profile;
  SplineState spline;
  VirtualAxes virtual_axes;
  GeometricElements elements;
  OpenRecords records;
  ProbingState probing;
  std::array<double, 320> own{};  ///< values that the language keeps for itself, by its own numbers
  std::uint16_t skip_levels = 0;  ///< bit n: blocks with the skip mark n are left out, 0: without a digit
  int optional_stop = -1;         ///< -1: left to the operator's switch
  long long executed = 0;
};

}  // namespace servogate::program
