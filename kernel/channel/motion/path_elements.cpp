// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/path_elements.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "kernel/channel/motion/surface_speed.hpp"
#include "kernel/channel/motion/texts.hpp"

namespace servogate::channel {

namespace {

path::Transition transition(const program::CornerRule& corner) {
  path::Transition t;
  t.continuation = static_cast<path::Continuation>(corner.transition);
  t.tolerance = corner.tolerance_mm;
  t.erf = corner.corner_error_mm;
  t.max_angle_deg = corner.max_angle_deg;
  t.confirm = true;
  return t;
}

}  // namespace

PathElements::PathElements(const path::Config& config, AxisMap axes, SpindleAt spindle_at)
    : config_(config), axes_(std::move(axes)), spindle_at_(spindle_at) {
  for (const int a : axes_.machine) own_ |= std::uint32_t{1} << a;
}

path::Vector PathElements::path_position(const program::Position& at) const {
  path::Vector path{};
  for (std::size_t i = 0; i < axes_.machine.size(); ++i)
    path[i] = at[static_cast<std::size_t>(axes_.machine[i])];
  return path;
}

int PathElements::foreign_axis(const program::Command& command, const program::Position& stands) const {
  if (const auto* windows = std::get_if<program::InPosition>(&command.what)) {
    const std::uint32_t others = windows->axes & ~own_;
    return others == 0 ? -1 : std::countr_zero(others);
  }
  const program::Position* const to = destination(command);
  if (to == nullptr) return -1;
  constexpr double kStands = 1e-9;  // mm or degrees
  for (const int axis : axes_.machine) {
    const auto a = static_cast<std::size_t>(axis);
    const bool own = (own_ >> a & 1u) != 0;
    if (!own && std::abs((*to)[a] - stands[a]) > kStands) return axis;
  }
  return -1;
}

void PathElements::restart(std::uint32_t machine_axes) noexcept {
  own(machine_axes);
  fastest_rps_ = 0.0;
}

/// A spindle word rests, and the spindle has its time.
void PathElements::take(const program::Spindle& spindle) {
  fastest_rps_ = 0.0;
  if (spindle.surface_speed) {
    surface_speed_ = spindle.speed;
    surface_limit_rpm_ = spindle.limit_rpm;
    surface_center_ = spindle.center;
  } else if (spindle.speed > 0.0) {
    surface_speed_ = 0.0;
    spindle_rpm_ = spindle.speed;
  }
}

path::Element PathElements::element(const program::Command& command, const path::Vector& from) const {
  path::Element e;
  if (const auto* rapid = std::get_if<program::Rapid>(&command.what)) {
    e.kind = path::Element::Kind::rapid;
    e.to = path_position(rapid->to);
    e.transition.confirm = true;
  } else if (const auto* line = std::get_if<program::Line>(&command.what)) {
    e.kind = path::Element::Kind::line;
    e.to = path_position(line->to);
    set_feed(e, from, line->feed, 0.0);
    e.transition = transition(line->corner);
  } else if (const auto* arc = std::get_if<program::Arc>(&command.what)) {
    e.kind = path::Element::Kind::arc;
    e.to = path_position(arc->to);
    const auto path_axis = [&](int machine_axis) {
      const auto it = std::find(axes_.machine.begin(), axes_.machine.end(), machine_axis);
      return static_cast<std::uint8_t>(it - axes_.machine.begin());
    };
    e.axis1 = path_axis(arc->axis1);
    e.axis2 = path_axis(arc->axis2);
    e.center1 = arc->center1;
    e.center2 = arc->center2;
    e.sweep_deg = arc->sweep_deg;
    const double radius = std::hypot(from[e.axis1] - e.center1, from[e.axis2] - e.center2);
    set_feed(e, from, arc->feed, radius * std::abs(arc->sweep_deg) * std::numbers::pi / 180.0);
    e.transition = transition(arc->corner);
  } else if (const auto* thread = std::get_if<program::Thread>(&command.what)) {
    e.to = path_position(thread->to);
    set_thread(e, from, *thread);
  } else if (const auto* probe = std::get_if<program::Probe>(&command.what)) {
    e.to = path_position(probe->to);
    e.feed = probe->feed_mm_min / 60.0;
  }
  return e;
}

/// Of the vector over millimetres and degrees.
double PathElements::length(const path::Element& e, const path::Vector& from, double arc_length) const {
  double square = arc_length * arc_length;
  for (std::size_t i = 0; i < axes_.machine.size(); ++i) {
    const bool in_plane = e.kind == path::Element::Kind::arc && (i == e.axis1 || i == e.axis2);
    if (!in_plane) square += (e.to[i] - from[i]) * (e.to[i] - from[i]);
  }
  return std::sqrt(square);
}

/// The lead is that of the axis with the longest way; parts of a chain that meet in a corner are rounded.
void PathElements::set_thread(path::Element& e, const path::Vector& from,
                              const program::Thread& thread) const {
  constexpr double kCorner = 0.02;  // mm
  double square = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < axes_.machine.size(); ++i) {
    const double d = std::abs(e.to[i] - from[i]);
    square += d * d;
    if (!config_.rotary[i]) longest = std::max(longest, d);
  }
  const double share = longest > 0.0 ? std::sqrt(square) / longest : 1.0;
  e.lock.kind = thread.tap ? path::Lock::Kind::tap_in : path::Lock::Kind::thread;
  e.lock.per_turn = thread.lead * share;
  e.lock.change = thread.lead_change * share;
  e.lock.start = thread.start_angle_deg / 360.0 - std::floor(thread.start_angle_deg / 360.0);
  e.revolutions = rpm(e, from, spindle_at_) / 60.0;
  e.feed = e.lock.per_turn * e.revolutions;
  if (thread.tap) return;
  e.transition.continuation = path::Continuation::continuous;
  e.transition.tolerance = kCorner;
}

/// A program's feed is that of the vector over millimetres and degrees alike (NC-110: specification A 17.1).
void PathElements::set_feed(path::Element& e, const path::Vector& from, const program::Feed& feed,
                            double arc_length) const {
  switch (feed.unit) {
    case program::FeedUnit::mm_per_min:
      e.feed = feed.value / 60.0;
      break;
    case program::FeedUnit::inverse_time:
      e.feed = feed.value * length(e, from, arc_length) / 60.0;
      break;
    case program::FeedUnit::mm_per_rev:
      e.revolutions = rpm(e, from, spindle_at_) / 60.0;
      e.feed = feed.value * e.revolutions;
      e.surface = surface(e, from);
      break;
  }
}

path::Surface PathElements::surface(const path::Element& e, const path::Vector& from) const {
  if (!by_surface()) return {};
  path::Surface surface;
  surface.speed = surface_speed_ * 1000.0 / 60.0;
  surface.center = surface_center_;
  surface.most = rpm(e, from, SpindleAt::fastest) / 60.0;
  surface.least = std::min(surface.most, axes_.spindle_min_rpm / 60.0);
  surface.axis = static_cast<std::uint8_t>(axes_.surface_speed_axis);
  follow_spindle(e, from, surface);
  return surface;
}

/// The path goes with the spindle, so that the square of its speed falls evenly along the path where it slows
/// down as fast as it can: dn/dt = -a and ds/dt = f n. Gives its speed in the end, and fills Surface::late.
/// Where the path is slower than its feed the spindle has slowed down more: then it is slower than planned,
/// which a course follows at once.
double PathElements::follow_spindle(const path::Element& e, const path::Vector& from,
                                    path::Surface& surface) const {
  constexpr double kStep = 0.05, kLeast = 4.0, kMost = 200.0;  // mm, and of them in an element
  constexpr double kSame = 1.001, kMargin = 1.004;             // of squares
  const path::Piece piece = path::shape(config_, from, e).piece;
  const double per_turn = e.feed / e.revolutions;
  if (!(axes_.spindle_rpm_s > 0.0) || !(per_turn > 0.0) || !(piece.length > 0.0)) return 0.0;
  const double count = std::clamp(std::ceil(piece.length / kStep), kLeast, kMost);
  const double step = piece.length / count, fall = axes_.spindle_rpm_s / 30.0 / per_turn;
  const auto asked = [&](double s) {
    const double turns = path::turns_at(surface, path::position(piece, s, config_.axis_count), 0.0);
    return turns * turns;
  };
  double square = std::max(asked(0.0), fastest_rps_ * fastest_rps_), late = 0.0, late_from = 0.0;
  if (square > kSame * asked(0.0)) late = square;
  for (double k = 1.0; k <= count; ++k) {
    const double before = square, now = asked(k * step);
    square = std::max(now, square - fall * step);
    if (late > 0.0 || square <= kSame * now) continue;
    late = before;
    late_from = (k - 1.0) * step;
  }
  surface.late = kMargin * late;
  surface.late_fall = fall;
  surface.late_from = late_from;
  return std::sqrt(square);
}

bool PathElements::by_surface() const { return surface_speed_ > 0.0 && axes_.surface_speed_axis >= 0; }

/// s that an element surely takes, without a feed per revolution.
double PathElements::shortest_time(const path::Element& e, const path::Vector& from) const {
  double seconds = 0.0;
  for (std::size_t i = 0; i < axes_.machine.size(); ++i)
    seconds = std::max(seconds, std::abs(e.to[i] - from[i]) / config_.limits[i].velocity);
  const bool slower = e.kind == path::Element::Kind::line && e.feed > 0.0;
  return slower ? std::max(seconds, length(e, from, 0.0) / e.feed / config_.largest_override) : seconds;
}

void PathElements::driven(const path::Element& e, const path::Vector& from) {
  if (!by_surface() || !(axes_.spindle_rpm_s > 0.0)) return;
  const double asked = rpm(e, e.to, SpindleAt::halfway) / 60.0;
  if (e.surface.speed > 0.0) {
    path::Surface surface = e.surface;
    surface.late = 0.0;
    fastest_rps_ = std::max(asked, follow_spindle(e, from, surface));
    return;
  }
  fastest_rps_ = std::max(fastest_rps_, rpm(e, from, SpindleAt::fastest) / 60.0);
  rested(shortest_time(e, from));
  fastest_rps_ = std::max(fastest_rps_, asked);
}

void PathElements::rested(double seconds) noexcept {
  fastest_rps_ = std::max(0.0, fastest_rps_ - axes_.spindle_rpm_s / 60.0 * seconds);
}

/// Distance from the spindle's axis that its speed on this element is reckoned with.
double PathElements::radius_of(const path::Element& e, const path::Vector& from_all, SpindleAt at) const {
  const auto axis = static_cast<std::size_t>(axes_.surface_speed_axis);
  const double from = from_all[axis] - surface_center_, to = e.to[axis] - surface_center_;
  if (at == SpindleAt::halfway) return std::abs(0.5 * (from + to));
  if (e.kind == path::Element::Kind::arc && (axis == e.axis1 || axis == e.axis2)) {
    const bool first = axis == e.axis1;
    const double bulge = std::hypot(from_all[e.axis1] - e.center1, from_all[e.axis2] - e.center2);
    return std::max(0.0, std::abs((first ? e.center1 : e.center2) - surface_center_) - bulge);
  }
  return from * to <= 0.0 ? 0.0 : std::min(std::abs(from), std::abs(to));
}

double PathElements::rpm(const path::Element& e, const path::Vector& from, SpindleAt at) const {
  const double high = axes_.spindle_max_rpm > 0.0 ? axes_.spindle_max_rpm : spindle_rpm_;
  if (!by_surface())
    return spindle_rpm_ > 0.0 ? std::clamp(spindle_rpm_, std::min(axes_.spindle_min_rpm, high), high) : 0.0;
  const double limit = surface_limit_rpm_ > 0.0 && axes_.spindle_max_rpm > 0.0
                           ? std::min(surface_limit_rpm_, axes_.spindle_max_rpm)
                           : std::max(surface_limit_rpm_, axes_.spindle_max_rpm);
  return std::max(surface_rpm(surface_speed_, radius_of(e, from, at), limit), axes_.spindle_min_rpm);
}

const program::Position* destination(const program::Command& command) {
  if (const auto* rapid = std::get_if<program::Rapid>(&command.what)) return &rapid->to;
  if (const auto* line = std::get_if<program::Line>(&command.what)) return &line->to;
  if (const auto* arc = std::get_if<program::Arc>(&command.what)) return &arc->to;
  if (const auto* thread = std::get_if<program::Thread>(&command.what)) return &thread->to;
  if (const auto* probe = std::get_if<program::Probe>(&command.what)) return &probe->to;
  return nullptr;
}

bool is_motion(const program::Command& command) { return destination(command) != nullptr; }

text::Finding foreign(const std::string& letter) {
  text::Finding finding;
  finding.entry = &texts::kForeignAxis;
  finding.arguments = {letter};
  return finding;
}

namespace {
text::Finding of_process(const text::Entry& entry, int process, std::string other) {
  text::Finding finding;
  finding.entry = &entry;
  finding.arguments = {std::to_string(process), std::move(other)};
  return finding;
}
}  // namespace

text::Finding no_such_process(int process, int processes) {
  return of_process(texts::kNoSuchProcess, process, std::to_string(processes));
}
text::Finding process_not_started(int process, const std::string& program) {
  return of_process(texts::kProcessNotStarted, process, program);
}
text::Finding program_not_found(int process, const std::string& program) {
  return of_process(texts::kProgramNotFound, process, program);
}

text::Finding rests_inside() {
  text::Finding finding;
  finding.severity = text::Severity::warning;
  finding.entry = &texts::kRestsInside;
  return finding;
}

text::Finding cannot_drive(path::Flaw flaw) {
  const text::Entry& why = texts::kFlaws[static_cast<std::size_t>(flaw)];
  text::Finding finding;
  finding.entry = &texts::kCannotDrive;
  finding.arguments = {text::both(why.english, why.russian)};
  return finding;
}

}  // namespace servogate::channel
