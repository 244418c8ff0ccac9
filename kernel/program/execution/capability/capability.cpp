// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/capability/capability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/program/geometry/circle.hpp"

namespace servogate::program {
namespace {

constexpr std::ptrdiff_t kPlaces = 20;  ///< told of a kind; a program of a million blocks must not flood
constexpr double kSlack = 1.0 + 1e-9;
constexpr double kDegree = std::numbers::pi / 180.0;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

/// Largest |cos| and |sin| of a direction that turns from `from` by `sweep` (degrees).
Point largest_share(double from_deg, double sweep_deg) {
  const double low = std::min(from_deg, from_deg + sweep_deg),
               high = std::max(from_deg, from_deg + sweep_deg);
  const auto passes = [&](double angle) { return std::ceil((low - angle) / 180.0) * 180.0 + angle <= high; };
  const auto larger = [&](auto function) {
    return std::max(std::abs(function(low * kDegree)), std::abs(function(high * kDegree)));
  };
  return {passes(0.0) ? 1.0 : larger([](double x) { return std::cos(x); }),
          passes(90.0) ? 1.0 : larger([](double x) { return std::sin(x); })};
}

}  // namespace

/// The speed that the axes reach along a path, by the slowest of them.
class Reach {
 public:
  /// `share`: how fast the axis moves when the path is driven at speed 1.
  void limit(const MachineModel& machine, int axis, double share) {
    const double rapid = machine.axes[at(axis)].rapid;
    if (share <= 0.0 || rapid <= 0.0 || rapid / share >= speed) return;
    speed = rapid / share;
    slowest = axis;
  }

  double speed = std::numeric_limits<double>::infinity();
  int slowest = -1;
};

Capability::Capability(const Dialect& dialect, const MachineModel& machine, const Block& block,
                       const Flow& flow, const Modes& modes, const FramesState& frames, MotionState& motion,
                       Warnings& warnings)
    : dialect_(dialect),
      machine_(machine),
      block_(block),
      flow_(flow),
      modes_(modes),
      frames_(frames),
      motion_(motion),
      warnings_(warnings),
      every_rapid_(std::numeric_limits<double>::infinity()) {
  for (int a = 0; a < machine.axis_count(); ++a) {
    const MachineModel::Axis& axis = machine.axes[at(a)];
    if (axis.rapid > 0.0) every_rapid_ = std::min(every_rapid_, axis.rapid);
    all_rapids_ += std::max(axis.rapid, 0.0);
    if (axis.diameter) surface_axis_ = a;
  }
}

Written Capability::written(int column) const noexcept {
  return {flow_.file(), flow_.line_number(), column, false};
}

void Capability::warn(Written& place, const text::Entry& told, std::vector<std::string> arguments) {
  if (place.told) return;
  place.told = true;
  const std::string& file = flow_.path(place.file);
  const text::Entry* kind = &told;
  const auto known = [&](const text::Finding& f) {
    return f.line == place.line && f.column == place.column && f.entry == kind && f.file == file;
  };
  if (std::any_of(warnings_.told.begin(), warnings_.told.end(), known)) return;
  const auto same = std::count_if(warnings_.told.begin(), warnings_.told.end(),
                                  [&](const text::Finding& f) { return f.entry == kind; });
  if (same > kPlaces) return;
  if (same == kPlaces) {
    // One more of the kind, so that the next one is beyond the count.
    arguments = {std::string(kind->id)};
    if (std::any_of(warnings_.told.begin(), warnings_.told.end(), [&](const text::Finding& f) {
          return f.entry == &entry(Fault::more_places) && f.arguments == arguments;
        }))
      return;
    kind = &entry(Fault::more_places);
  }
  warnings_.told.push_back(
      {text::Severity::warning, file, place.line, place.column, kind, std::move(arguments)});
}

void Capability::check_tool(int column) {
  if (machine_.tool_places > 0 && frames_.tool > machine_.tool_places)
    fail(Fault::tool_outside, column, {std::to_string(frames_.tool), std::to_string(machine_.tool_places)});
  const auto& correctors = frames_.tables->correctors;
  if (frames_.corrector == 0 || correctors.empty() || correctors.contains(frames_.corrector)) return;
  Written place = written(column);
  warn(place, Fault::corrector_missing, {std::to_string(frames_.corrector)});
}

void Capability::check_start(const Word& word) {
  if (modes_.speed <= 0.0 && motion_.speed_at.line == 0) {
    Written place = written(word.column);
    warn(place, Fault::no_speed, {word_text(dialect_, block_, word)});
  }
  if (modes_.speed > 0.0 && !modes_.cutting && modes_.spindle == Function::surface_speed &&
      surface_axis_ >= 0)
    fail(Fault::no_cutting_speed, word.column, {word_text(dialect_, block_, word)});
}

void Capability::check_speed(const Word& word) {
  if (modes_.speed <= 0.0) return;
  if (modes_.spindle == Function::surface_speed) {
    if (surface_axis_ < 0) fail(Fault::surface_speed_axis, word.column, {word_text(dialect_, block_, word)});
    return;
  }
  const double low = machine_.spindle_min_rpm, high = machine_.spindle_max_rpm;
  const std::string asked = text::number(modes_.speed);
  if (high > 0.0 && modes_.speed > high * kSlack)
    warn(motion_.speed_at, Fault::speed_above, {asked, text::number(high)});
  else if (modes_.speed * kSlack < low)
    warn(motion_.speed_at, Fault::speed_below, {asked, text::number(low)});
}

double Capability::spindle_rpm(const Position& to) const {
  const double high = machine_.spindle_max_rpm;
  double rpm = modes_.speed;
  if (modes_.cutting) {
    if (surface_axis_ < 0) return 0.0;
    const double center = frames_.frame.length(surface_axis_);
    const double from = frames_.machine[at(surface_axis_)] - center, end = to[at(surface_axis_)] - center;
    const double radius = from * end <= 0.0 ? 0.0 : std::min(std::abs(from), std::abs(end));
    if (radius == 0.0) return high;
    rpm = modes_.speed * 1000.0 / (2.0 * std::numbers::pi * radius);
  }
  return high > 0.0 ? std::min(rpm, high) : rpm;
}

/// Path speed in mm/s, degrees/s where only rotary axes move; 0: not known.
double Capability::path_speed(const Feed& feed, double length, const Position& to) const {
  switch (feed.unit) {
    case FeedUnit::mm_per_min:
      return feed.value / 60.0;
    case FeedUnit::inverse_time:
      return feed.value * length / 60.0;
    case FeedUnit::mm_per_rev:
      return feed.value * spindle_rpm(to) / 60.0;
  }
  return 0.0;
}

/// A feed per revolution while nothing turns; told once.
void Capability::check_turning(const Feed& feed) {
  const bool turns = motion_.spindle == SpindleMode::cw || motion_.spindle == SpindleMode::ccw;
  if (feed.unit != FeedUnit::mm_per_rev || turns || warnings_.standing_told) return;
  const int column = static_cast<int>(block_.body) + 1;
  if (dialect_.standing_is_error) fail(Fault::spindle_stands, column);
  warnings_.standing_told = true;
  Written place = written(column);
  warn(place, Fault::spindle_stands, {});
}

void Capability::check_line(const BlockWords& words, const Line& line) {
  const Feed& feed = line.feed;
  const Position& to = line.to;
  if (motion_.dry_run) return;
  if (feed.unit == FeedUnit::mm_per_min && feed.value <= every_rapid_ * 60.0) return;
  check_turning(feed);
  double square = 0.0;
  bool linear = false;
  for (int a = 0; a < machine_.axis_count(); ++a) {
    const double delta = to[at(a)] - frames_.machine[at(a)];
    square += delta * delta;
    linear = linear || (delta != 0.0 && !machine_.rotary(a));
  }
  const double length = std::sqrt(square);
  if (length <= 0.0) return;
  Reach reach;
  for (int a = 0; a < machine_.axis_count(); ++a)
    reach.limit(machine_, a, std::abs(to[at(a)] - frames_.machine[at(a)]) / length);
  check_feed(words, path_speed(feed, length, to), reach, linear);
}

void Capability::check_arc(const BlockWords& words, const Arc& arc, double radius, double length) {
  if (motion_.dry_run) return;
  if (arc.feed.unit == FeedUnit::mm_per_min && arc.feed.value <= every_rapid_ * 60.0) return;
  check_turning(arc.feed);
  if (length <= 0.0) return;
  const double start =
      std::atan2(frames_.machine[at(arc.axis2)] - arc.center2, frames_.machine[at(arc.axis1)] - arc.center1) /
      kDegree;
  const Point tangent = largest_share(start + 90.0, arc.sweep_deg);
  const double along = std::abs(arc.sweep_deg) * kDegree * radius / length;
  Reach reach;
  for (int a = 0; a < machine_.axis_count(); ++a) {
    double share = std::abs(arc.to[at(a)] - frames_.machine[at(a)]) / length;
    if (a == arc.axis1) share = along * tangent.x;
    if (a == arc.axis2) share = along * tangent.y;
    reach.limit(machine_, a, share);
  }
  check_feed(words, path_speed(arc.feed, length, arc.to), reach, true);
}

void Capability::check_feed(const BlockWords& words, double speed, const Reach& reach, bool linear) {
  if (reach.slowest < 0 || speed <= reach.speed * kSlack) return;
  const auto per_minute = [&](double mm_s) {
    const std::string number = text::number(mm_s * 60.0, 1);
    return linear ? text::both(number + " mm", number + " мм") : text::both(number + "°", number + "°");
  };
  const Word* own = words.time != nullptr                   ? words.time
                    : modes_.feed == Function::feed_inverse ? words.feed
                                                            : nullptr;
  Written once = written(own != nullptr ? own->column : 0);
  warn(own != nullptr ? once : motion_.feed_at, Fault::feed_above,
       {own != nullptr ? word_text(dialect_, block_, *own) : "F" + text::number(motion_.feed),
        per_minute(speed), std::to_string(flow_.line_number()), per_minute(reach.speed),
        machine_.axes[at(reach.slowest)].letter});
}

}  // namespace servogate::program
