// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/process_image.hpp"

namespace servogate::program {

/// Absolute machine coordinates of the tool's control point, index = axis order of the machine file; mm,
/// degrees; a lathe's X is a radius.
using Position = std::array<double, image::kMaxAxes>;

enum class FeedUnit : std::uint8_t { mm_per_min, mm_per_rev, inverse_time };
struct Feed {
  double value = 0.0;
  FeedUnit unit = FeedUnit::mm_per_min;
};

/// How the path passes from this element to the next one.
enum class Transition : std::uint8_t {
  exact_stop,      ///< speed zero and in position at the end
  continuous,      ///< rounded within the contour tolerance, no further slow-down
  corner_limited,  ///< as continuous, and the corner speed by the error and angle below
};
struct CornerRule {
  Transition transition = Transition::exact_stop;
  double tolerance_mm = 0.0;     ///< contour tolerance of this element; 0: stop at its end
  double corner_error_mm = 0.0;  ///< form error that bounds the corner speed
  double max_angle_deg = 180.0;  ///< a sharper corner stops
};

struct Rapid {
  Position to{};
};
struct Line {
  Position to{};
  Feed feed;
  CornerRule corner;
};
/// Circular in the plane (`axis1`, `axis2`) about `center`, sweep in degrees, + from axis1 towards axis2;
/// every other axis moves linearly with the angle (helix).
struct Arc {
  Position to{};
  std::uint8_t axis1 = 0, axis2 = 1;
  double center1 = 0.0, center2 = 0.0;
  double sweep_deg = 0.0;
  Feed feed;
  CornerRule corner;
};
/// A motion by the measured turns of the spindle, along which the longest axis moves by `lead` mm in each,
/// and by `lead_change` more in each that follows; it begins at an angle behind the zero mark.
struct Thread {
  Position to{};
  double lead = 0.0, lead_change = 0.0, start_angle_deg = 0.0;
  bool tap = false;  ///< to the depth; behind it come the spindle reversed and the same way back
};
struct Dwell {
  double seconds = 0.0;
};
enum class SpindleMode : std::uint8_t {
  keep,
  cw,
  ccw,
  stop,
  orient,
  turn,  ///< an oriented spindle turns on by an angle at its speed, and is held there
};
struct Spindle {
  std::uint8_t number = 0;
  SpindleMode mode = SpindleMode::keep;
  double speed = 0.0;
  bool surface_speed = false;  ///< m/min instead of rpm
  double limit_rpm = 0.0;      ///< for surface speed, 0: none
  /// For surface speed: machine coordinate of the diameter axis at which the tool stands on the spindle's
  /// axis, that is its length along it.
  double center = 0.0;
  double turn_deg = 0.0;  ///< of SpindleMode::turn, + clockwise
};
/// Tool word. `activate` true: the corrector takes effect here, else it is a preselection.
struct Tool {
  std::int32_t number = 0;
  std::int32_t corrector = 0;
  bool activate = false;
};
/// An M function; `after_motion` tells its class. The control waits for the PLC's acknowledgement.
struct MFunction {
  std::int32_t code = 0;
  bool after_motion = false;
};
struct HFunction {
  std::int32_t code = 0;
};
struct Message {
  std::string text;
};
/// A write into packet A, K or V that takes effect in path order.
struct WritePlace {
  image::Place place;
  double value = 0.0;
  std::string characters;   ///< for CH places
  bool synchronous = true;  ///< wait for the motion before it; otherwise at once
};
/// Waits until a place compares as wished; canon reports and passes it.
struct Wait {
  image::Place place;
  enum class Compare : std::uint8_t { eq, ne, lt, le, gt, ge } compare = Compare::eq;
  double value = 0.0;
};
/// Program stop: M00 (always) or M01 (when optional stop is on).
struct Stop {
  bool optional = false;
};
/// A motion until the probe touches, at most to `to`, which it does not reach unless nothing is there.
struct Probe {
  Position to{};
  double feed_mm_min = 0.0;
};

/// The next motion begins when the spindle passes its zero mark.
struct SpindleMark {};
/// The second spindle follows the angle of the first: `follower` turns of it for `leader` turns, `phase_deg`
/// ahead of that; off: it stops.
struct SpindleCoupling {
  bool on = false;
  std::int32_t leader = 1, follower = 1;  ///< turns; `follower` below 0: it turns the other way
  double phase_deg = 0.0;
};
/// The first spindle becomes the rotary axis that the machine file names; off: it is a spindle at rest again.
struct SpindleAxis {
  bool on = false;
};
/// What one process asks of another, which has a number from 1 (0: the process itself).
struct ProcessOrder {
  enum class Action : std::uint8_t {
    start,    ///< loads `program` into it and starts it
    release,  ///< unloads the program that asks
    restart,  ///< ends its wait for this process
    wait,     ///< waits until it ends the wait
  };
  Action action = Action::start;
  std::int32_t process = 0;
  std::string program;
  bool after_motion = false;  ///< when the motion before it has ended, otherwise at once
};
/// When an axis counts as in position from here on, mm or degrees; 0: as the machine has it. Axes without
/// their bit in `axes` keep theirs.
struct InPosition {
  Position window{};
  std::uint32_t axes = 0;
};

/// Whether the override of the feed counts from here on, up to the end of the program: a tap in a
/// compensating chuck goes at its feed.
struct FeedOverride {
  bool effective = true;
};

/// End of the main program (M02, M30 or its last line).
struct End {
  bool rewind = false;
};

/// One canonical command with the place it comes from.
struct Command {
  int line = 0;  ///< 1-based line of the file
  int file = 0;  ///< 0: main program
  int process = 0;
  std::int32_t block = -1;  ///< N number, -1: none
  std::variant<Rapid, Line, Arc, Thread, Dwell, Spindle, Tool, MFunction, HFunction, Message, WritePlace,
               Wait, Stop, Probe, End, SpindleMark, ProcessOrder, InPosition, FeedOverride, SpindleCoupling,
               SpindleAxis>
      what;
};

/// One JSON object a line, the contract of `servogate canon` (docs/canon.md). `letters` = axis letters in
/// order.
std::string to_json(const Command& command, const std::vector<std::string>& letters,
                    const std::vector<std::string>& files);
/// The same, appended to `out` without a line end; allocates only when `out` has to grow.
void append_json(std::string& out, const Command& command, const std::vector<std::string>& letters,
                 const std::vector<std::string>& files);

}  // namespace servogate::program
