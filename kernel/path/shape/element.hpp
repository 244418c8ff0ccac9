// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "firmware_if/image/process_image.hpp"

namespace servogate::path {

inline constexpr int kMaxAxes = image::kMaxPathAxes;

/// One value per path axis, index 0 to Config::axis_count - 1; the channel maps path axes to the machine's.
/// mm for a linear axis, degrees for a rotary one. Places beyond axis_count are zero.
using Vector = std::array<double, kMaxAxes>;

/// What the set-point of one axis never exceeds: mm/s, mm/s2, mm/s3 (degrees for a rotary axis). All > 0.
struct AxisLimits {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

/// One value for each axis.
constexpr std::array<double, kMaxAxes> on_all_axes(double value) noexcept {
  std::array<double, kMaxAxes> all{};
  all.fill(value);
  return all;
}

/// What a motion by the turns of the spindle does where it cannot be driven to its end.
struct Threads {
  /// mm (degrees) by which each axis leaves the thread when its master is lost or the motion is stopped; all
  /// 0: the path only slows down. Lock says where the sign is another one.
  std::array<double, kMaxAxes> retract{};
  bool by_infeed = false;      ///< whoever makes the elements: each leaves to where it came from (Lock)
  bool hold_retracts = false;  ///< a hold leaves the thread, otherwise the pass goes on to its end
  double window = 0.2;         ///< mm of path: further off its master it is left
  double tap_overshoot = 3.0;  ///< mm that a tap may go beyond its depth with its spindle, > 0
  /// Travel of each axis, machine coordinates: the way off a thread ends there at the latest.
  std::array<double, kMaxAxes> travel_min = on_all_axes(-std::numeric_limits<double>::infinity());
  std::array<double, kMaxAxes> travel_max = on_all_axes(std::numeric_limits<double>::infinity());
};

class Transformation;
/// Path coordinates are those of the axes.
const Transformation& identity() noexcept;

/// The machine as this room sees it.
struct Config {
  int axis_count = 3;  ///< 1 - kMaxAxes
  std::array<AxisLimits, kMaxAxes> limits{};
  std::array<bool, kMaxAxes> rotary{};
  double period_s = 0.001;              ///< length of a cycle
  double largest_override = 1.5;        ///< feed override never exceeds this ratio
  std::uint32_t piece_capacity = 8192;  ///< look-ahead in pieces of geometry (about 0.8 kB each), >= 1024
  /// Share of the axes' limits that a course leaves for changes of rate, 0.002 to 0.2: more of it stops
  /// sooner and takes longer.
  double reserve = 0.01;
  const Transformation* transformation = &identity();  ///< axes/; from path coordinates to the axes
  Threads threads{};
};

/// Where an element comes from, carried to the set-point: for displays, alarms and traces.
struct Tag {
  std::int32_t line = 0;  ///< 1-based line of the file, 0: none
  std::int32_t file = 0;
  std::int32_t block = -1;  ///< N number
  std::int16_t process = 0;
  std::uint64_t command = 0;  ///< number of the block, rising along the path; the channel's own counting
  std::uint32_t marks = 0;    ///< marks before it on the path (Planner::add_mark()); filled by the planner
  bool operator==(const Tag&) const = default;
};

/// How the path goes on behind an element.
enum class Continuation : std::uint8_t {
  exact_stop,      ///< comes to rest in the end point
  continuous,      ///< the corner is rounded within the tolerance
  corner_limited,  ///< as continuous, and the corner speed obeys erf and max_angle as well (NC-110 G27)
};

struct Transition {
  Continuation continuation = Continuation::exact_stop;
  double tolerance = 0.0;      ///< mm: largest distance of set-point path and programmed path; 0: stop
  double erf = 0.0;            ///< mm: form error that bounds the corner speed (corner_limited); 0: stop
  double max_angle_deg = 180;  ///< a sharper change of direction stops (corner_limited), 0 - 180
  bool confirm = false;        ///< an exact stop waits for Follower::release_stop() (in-position check)
};

/// Constant surface speed along an element: the further the tool is from the spindle's axis, the slower it
/// turns.
struct Surface {
  double speed = 0.0;              ///< mm/s at the tool; 0: the spindle turns the same everywhere
  double center = 0.0;             ///< mm: of the spindle, along `axis`
  double least = 0.0, most = 0.0;  ///< revolutions a second on this element, > 0
  std::uint8_t axis = 0;           ///< path axis of the tool's distance
  /// A spindle that cannot slow down as fast as that is faster: from `late_from` mm of the element on the
  /// square of its revolutions a second is `late`, less `late_fall` in each mm. 0: it is nowhere.
  double late = 0.0, late_fall = 0.0, late_from = 0.0;
};

/// Speed of the spindle at a place of an element, `s` mm behind its begin, revolutions a second. real-time
/// safe.
inline double turns_at(const Surface& surface, const Vector& x, double s) noexcept {
  const double around = 2.0 * std::numbers::pi * std::abs(x[surface.axis] - surface.center);
  const double free = around * surface.most > surface.speed ? surface.speed / around : surface.most;
  const double asked = std::max(surface.least, free);
  const double late = surface.late - surface.late_fall * (s - surface.late_from);
  return s >= surface.late_from && late > asked * asked ? std::sqrt(late) : asked;
}

/// Motion by the angle of the spindle: the path parameter goes with the measured revolutions.
struct Lock {
  enum class Kind : std::uint8_t {
    none,
    thread,   ///< begins at an angle of the spindle, ends at its end whatever the spindle does then
    tap_in,   ///< a line at whose end the spindle turns round; the next element leads back along it
    tap_out,  ///< the last line of a tap, on which it leaves the hole
  };
  Kind kind = Kind::none;
  double per_turn = 0.0;  ///< mm of path in a revolution where the element begins, > 0
  double change = 0.0;    ///< of that in each revolution
  double start =
      0.0;  ///< revolutions from the zero mark to where the thread begins, 0 - 1; of its first element
  double dwell = 0.0;         ///< tap_in: s that the spindle stands at its end before it turns round
  double turn_rpm = 0.0;      ///< tap_in: speed of the spindle from there on; 0: as before
  std::int8_t turn = 0;       ///< tap_in: how it turns from there on, + clockwise, - counter-clockwise
  std::uint16_t stays = 0;    ///< thread: axes of the path, as bits, that do not leave it
  std::uint16_t against = 0;  ///< thread: those that leave it against the sign of Threads::retract
  bool operator==(const Lock&) const = default;

  /// mm of path in a revolution, `s` behind the begin of the element. real-time safe.
  double per_turn_at(double s) const noexcept {
    return std::sqrt(std::max(0.0, per_turn * per_turn + 2.0 * change * s));
  }
};

/// One element of the programmed path, from where the one before ends.
struct Element {
  enum class Kind : std::uint8_t { line, arc, rapid };
  Kind kind = Kind::line;
  Vector to{};
  /// arc only: about (center1, center2) in the plane of path axes axis1 and axis2, sweep + from axis1 to
  /// axis2, whole turns included; all other axes move linearly with the angle (helix).
  std::uint8_t axis1 = 0, axis2 = 1;
  double center1 = 0.0, center2 = 0.0;
  double sweep_deg = 0.0;
  /// Speed of the vector over mm and degrees, mm/s (degrees/s); > 0. A rapid ignores it and is as fast as the
  /// axis limits; it always starts and ends with an exact stop.
  double feed = 0.0;
  /// Feed per revolution: `feed` is that at so many revolutions a second of the spindle, the most that it is
  /// planned for, and it goes with the speed that Follower::set_spindle() tells; 0: feed per time.
  double revolutions = 0.0;
  Lock lock{};      ///< lines: driven by the spindle's angle, with `feed` at so many `revolutions`
  Surface surface;  ///< of a feed per revolution; courses follow it from place to place
  Transition transition;
  std::uint8_t limit_set = 0;  ///< reserved: rough, finish, thread
  Tag tag;
};

}  // namespace servogate::path
