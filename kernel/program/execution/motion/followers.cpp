// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/motion/followers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "kernel/program/geometry/degrees.hpp"

namespace servogate::program {
namespace {

constexpr double kTolerance = 0.0005;  ///< mm that chords leave the path by
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFirstDegrees = 10.0;  ///< an arc is divided at least so finely
constexpr int kDeepest = 16;            ///< halvings of a part
constexpr double kMostParts = 100'000.0;
constexpr double kStill = 1e-9;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

}  // namespace

VirtualAxes no_virtual_axes(const MachineModel& machine) {
  VirtualAxes axes;
  for (int a = machine.real_axes(); a < machine.axis_count(); ++a) axes.barred |= 1u << a;
  return axes;
}

void end_virtual_axes(const MachineModel& machine, VirtualAxes& axes, Position& at_) {
  axes = no_virtual_axes(machine);
  for (int a = machine.real_axes(); a < machine.axis_count(); ++a) at_[at(a)] = 0.0;
}

Position Followers::Way::place(double share) const {
  Position p = from;
  for (std::size_t a = 0; a < p.size(); ++a) p[a] += (to[a] - from[a]) * share;
  if (arc == nullptr || share >= 1.0) return share >= 1.0 ? to : p;
  const double x = from[arc->axis1] - arc->center1, y = from[arc->axis2] - arc->center2;
  const double angle = arc->sweep_deg * share;
  p[arc->axis1] = arc->center1 + x * cos_deg(angle) - y * sin_deg(angle);
  p[arc->axis2] = arc->center2 + x * sin_deg(angle) + y * cos_deg(angle);
  return p;
}

void Followers::lead(std::vector<Command>& commands) {
  std::vector<Command> out;
  for (const Command& command : commands) {
    try {
      if (!take(command, out)) out.push_back(command);
    } catch (ProgramError& error) {
      // The element of a contour is given behind the block that follows it.
      if (command.line == line_) throw;
      error.line = command.line;
      error.column = 1;
      throw;
    }
  }
  commands = std::move(out);
  for (int i = 0; i < axes_.followers; ++i)
    at_.machine[at(axes_.follower[at(i)])] = axes_.at[at(axes_.follower[at(i)])];
}

bool Followers::take(const Command& command, std::vector<Command>& out) {
  if (const auto* way = std::get_if<Rapid>(&command.what))
    rapid(command, *way, out);
  else if (const auto* line = std::get_if<Line>(&command.what))
    feed(command, *line, nullptr, out);
  else if (const auto* arc = std::get_if<Arc>(&command.what))
    feed(command, *arc, arc, out);
  else if (std::holds_alternative<Thread>(command.what) || std::holds_alternative<Probe>(command.what))
    fail(Fault::virtual_motion, column_);
  else
    return false;
  return true;
}

/// Each axis goes its own way at rapid, as without virtual axes.
void Followers::rapid(const Command& command, const Rapid& rapid, std::vector<Command>& out) {
  Position to = followed(rapid.to, axes_.at);
  if (axes_.kind == VirtualAxes::Kind::polar)
    check_radius(std::hypot(rapid.to[at(axes_.leader[0])], rapid.to[at(axes_.leader[1])]));
  check_travel(to);
  axes_.at = to;
  Command given_command = command;
  given_command.what = Rapid{given(to)};
  out.push_back(std::move(given_command));
}

template <typename What>
void Followers::feed(const Command& command, const What& what, const Arc* arc, std::vector<Command>& out) {
  Way way{axes_.at, what.to, arc};
  way.length = length_of(way);
  if (axes_.kind == VirtualAxes::Kind::polar) check_radius(nearest(way));
  double done = 0.0;
  const std::vector<Chord> parts = chords(way);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool last = i + 1 == parts.size();
    check_travel(parts[i].end);
    Line line{given(parts[i].end), feed_of(what.feed, parts[i].until - done, way.length), what.corner};
    if (!last && line.corner.transition == Transition::exact_stop)
      line.corner = {Transition::continuous, machine_.contour_tolerance_mm, 0.0, 180.0};
    done = parts[i].until;
    Command part = command;
    part.what = line;
    out.push_back(std::move(part));
  }
  axes_.at = parts.back().end;
}

bool Followers::follows(int axis) const {
  const auto end = axes_.follower.begin() + axes_.followers;
  return std::find(axes_.follower.begin(), end, axis) != end;
}

/// All axes where the leaders stand at `place`; a rotary follower takes the turn next to `before`.
Position Followers::followed(const Position& place, const Position& before) const {
  Position out = place;
  const auto shift = [this](int axis) { return at_.frame.shift(axis); };
  if (axes_.kind == VirtualAxes::Kind::polar) {
    const double u = place[at(axes_.leader[0])], v = place[at(axes_.leader[1])];
    const int linear = axes_.follower[0], rotary = axes_.follower[1];
    const double angle = std::atan2(v, u) / kDegree, from = before[at(rotary)] - shift(rotary);
    out[at(linear)] = shift(linear) + std::hypot(u, v);
    out[at(rotary)] = shift(rotary) + angle + 360.0 * std::round((from - angle) / 360.0);
    return out;
  }
  for (int i = 0; i < axes_.followers; ++i) {
    double sum = shift(axes_.follower[at(i)]);
    for (int k = 0; k < axes_.leaders; ++k) {
      const int leader = axes_.leader[at(k)];
      sum += axes_.share[at(i)][at(k)] *
             (place[at(leader)] - (machine_.is_virtual(leader) ? 0.0 : shift(leader)));
    }
    out[at(axes_.follower[at(i)])] = sum;
  }
  return out;
}

/// How far a point of a chord lies beside the place of the path that it stands for, mm.
double Followers::beside(const Position& chord, const Position& place) const {
  double square = 0.0;
  for (int i = 0; i < axes_.followers; ++i) {
    const int axis = axes_.follower[at(i)];
    double off = chord[at(axis)] - place[at(axis)];
    if (machine_.rotary(axis)) {
      const bool polar = axes_.kind == VirtualAxes::Kind::polar;
      const int linear = axes_.follower[0];
      off *= kDegree * (polar ? place[at(linear)] - at_.frame.shift(linear) : axes_.radius);
    }
    square += off * off;
  }
  return std::sqrt(square);
}

void Followers::divide(const Way& way, double from, const Position& begin, double to, const Position& end,
                       int depth, std::vector<Chord>& out) const {
  const double middle = (from + to) / 2.0;
  const Position place = followed(way.place(middle), begin);
  Position chord;
  for (std::size_t a = 0; a < chord.size(); ++a) chord[a] = (begin[a] + end[a]) / 2.0;
  if (depth == kDeepest || beside(chord, place) <= kTolerance) {
    out.push_back({to, end});
    return;
  }
  divide(way, from, begin, middle, place, depth + 1, out);
  divide(way, middle, place, to, end, depth + 1, out);
}

std::vector<Followers::Chord> Followers::chords(const Way& way) const {
  double parts = 1.0;
  if (way.arc != nullptr) {
    parts = std::ceil(std::abs(way.arc->sweep_deg) / kFirstDegrees);
    // Seen from the centre, less than half a turn from one place to the next.
    if (axes_.kind == VirtualAxes::Kind::polar)
      parts = std::max(parts, std::ceil(way.length / axes_.least_radius));
  }
  const int count = static_cast<int>(std::clamp(parts, 1.0, kMostParts));
  std::vector<Chord> out;
  Position begin = way.from;
  for (int i = 1; i <= count; ++i) {
    const double from = static_cast<double>(i - 1) / count, to = static_cast<double>(i) / count;
    const Position end = followed(way.place(to), begin);
    divide(way, from, begin, to, end, 0, out);
    begin = end;
  }
  return out;
}

/// Of the axes that a program moves.
double Followers::length_of(const Way& way) const {
  double square = 0.0;
  for (int a = 0; a < machine_.axis_count(); ++a) {
    if (follows(a) || (way.arc != nullptr && (a == way.arc->axis1 || a == way.arc->axis2))) continue;
    square += std::pow(way.to[at(a)] - way.from[at(a)], 2);
  }
  if (way.arc != nullptr)
    square += std::pow(
        std::hypot(way.from[way.arc->axis1] - way.arc->center1, way.from[way.arc->axis2] - way.arc->center2) *
            way.arc->sweep_deg * kDegree,
        2);
  return std::sqrt(square);
}

/// Distance of the way from the centre of the rotary axis.
double Followers::nearest(const Way& way) const {
  const auto u = at(axes_.leader[0]), v = at(axes_.leader[1]);
  const double x = way.from[u], y = way.from[v];
  const double end = std::hypot(way.to[u], way.to[v]), begin = std::hypot(x, y);
  if (way.arc != nullptr && way.arc->axis1 + way.arc->axis2 == axes_.leader[0] + axes_.leader[1]) {
    const Arc& arc = *way.arc;
    const double first = std::atan2(way.from[arc.axis2] - arc.center2, way.from[arc.axis1] - arc.center1);
    const double towards = std::atan2(-arc.center2, -arc.center1);
    const double turn = (arc.sweep_deg < 0.0 ? first - towards : towards - first) / kDegree;
    if (turn - 360.0 * std::floor(turn / 360.0) > std::abs(arc.sweep_deg)) return std::min(begin, end);
    const double radius = std::hypot(way.from[arc.axis1] - arc.center1, way.from[arc.axis2] - arc.center2);
    return std::abs(std::hypot(arc.center1, arc.center2) - radius);
  }
  const double dx = way.to[u] - x, dy = way.to[v] - y, square = dx * dx + dy * dy;
  if (square == 0.0) return begin;
  const double foot = std::clamp(-(x * dx + y * dy) / square, 0.0, 1.0);
  return std::hypot(x + foot * dx, y + foot * dy);
}

void Followers::check_radius(double nearest) const {
  if (nearest < axes_.least_radius - 1e-6)
    fail(Fault::virtual_radius, column_, {text::number(nearest, 4), text::number(axes_.least_radius, 4)});
}

/// The programmed speed along the programmed path, whatever the followers do.
Feed Followers::feed_of(const Feed& programmed, double share, double length) const {
  if (axes_.keeps_lengths && programmed.unit != FeedUnit::inverse_time) return programmed;
  if (programmed.unit == FeedUnit::mm_per_rev) fail(Fault::virtual_feed, column_);
  if (programmed.unit == FeedUnit::inverse_time) return {programmed.value / share, FeedUnit::inverse_time};
  if (length * share < kStill) return programmed;
  return {programmed.value / (length * share), FeedUnit::inverse_time};
}

void Followers::check_travel(const Position& to) const {
  for (int i = 0; i < axes_.followers; ++i)
    frames_.check_axis(axes_.follower[at(i)], to[at(axes_.follower[at(i)])], column_);
}

/// What the machine is told: it has no virtual axes.
Position Followers::given(Position to) const {
  for (int a = machine_.real_axes(); a < machine_.axis_count(); ++a) to[at(a)] = 0.0;
  return to;
}

}  // namespace servogate::program
