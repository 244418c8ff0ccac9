// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace servogate::program {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

}  // namespace

void Motion::move(const BlockWords& words) {
  const bool arcs = modes_.motion != Function::rapid && modes_.motion != Function::line;
  if (arcs) frames_.need_plane(here());
  if (words.has_factors) check_factors(words);
  const Position to = target_of(words);
  index(to);
  if (only_indexes(words)) return;
  switch (modes_.motion) {
    case Function::rapid:
      give(words, Rapid{to}, to);
      break;
    case Function::line:
      line(words, to);
      break;
    default:
      arc(words, to);
      break;
  }
  state_.profile_open = modes_.motion != Function::rapid && modes_.corner != Function::exact;
  at_.machine = to;
}

/// A motion in the order of the program: at once, or by way of the contour.
template <typename What>
void Motion::give(const BlockWords& words, What&& what, const Position& to) {
  const int a1 = at_.axis1, a2 = at_.axis2;
  if (a1 < 0 || a2 < 0 || contour_.idle()) {
    if (at_.zones_active) {
      if constexpr (std::is_same_v<std::decay_t<What>, Arc>)
        frames_.check_zones(at_.machine, what, here());
      else
        frames_.check_zones(at_.machine, to, here());
    }
    return output_.emit(std::forward<What>(what));
  }
  output_.check(what);
  ContourElement e;
  e.in_plane = words.axis[at(a1)] != nullptr || words.axis[at(a2)] != nullptr;
  e.start = {at_.machine[at(a1)], at_.machine[at(a2)]};
  e.end = {to[at(a1)], to[at(a2)]};
  e.to = to;
  e.place = contour_.place(here(), block_.number);
  if constexpr (std::is_same_v<std::decay_t<What>, Rapid>) {
    e.rapid = true;
  } else {
    e.feed = what.feed;
    e.corner = what.corner;
  }
  if constexpr (std::is_same_v<std::decay_t<What>, Arc>) {
    e.arc = true;
    e.centre = {what.center1, what.center2};
    e.sweep_deg = what.sweep_deg;
  }
  contour_.take(std::move(e));
}

/// Adds a share of the tool's radius to a coordinate of the block; what is reached stays (specification A
/// 15).
void Motion::add_factor(const BlockWords& words, int axis) {
  const Word* word = at(axis) < words.factor.size() ? words.factor[at(axis)] : nullptr;
  if (word == nullptr) return;
  const double radius = frames_.tool_radius() + state_.allowance;
  at_.programmed[at(axis)] += numbers_.resolve(word->value) * radius / std::abs(at_.frame.scale(axis));
}

/// Each share of the tool's radius stands beside the coordinate of its axis.
void Motion::check_factors(const BlockWords& words) const {
  for (std::size_t f = 0; f < words.factor.size(); ++f) {
    const Word* word = words.factor[f];
    const bool known = static_cast<int>(f) < machine_.axis_count();
    if (word == nullptr || (known && words.axis[f] != nullptr && !words.machine_zero)) continue;
    fail(Fault::factor_axis, word->column,
         {std::string(1, word->letter), known ? machine_.axes[f].letter : text::both("an axis", "оси")});
  }
}

Position Motion::across(const BlockWords& words, Position from) {
  for (int a = 0; a < machine_.axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    if (a == at_.axis1 || a == at_.axis2)
      fail(Fault::word_without_function, word->column, {word_text(dialect_, block_, *word)});
    at_.programmed[at(a)] = numbers_.length(a, word->value);
    from[at(a)] = at_.frame.to_machine(at_.programmed, a);
    frames_.check_axis(a, from[at(a)], word->column);
  }
  return from;
}

void Motion::thread(const Thread& thread) {
  output_.emit(thread);
  at_.machine = thread.to;
}

Position Motion::target_of(const BlockWords& words) {
  Position& programmed = at_.programmed;
  Position to = at_.machine;
  const Frame& frame = at_.frame;
  const int axes = machine_.axis_count();
  bool turned = false;
  for (int a = 0; a < axes; ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    const double value = machine_.axes[at(a)].index_positions > 0 ? index_angle(a, word->value)
                                                                  : numbers_.length(a, word->value);
    if (words.machine_zero) {
      to[at(a)] = value + frame.length(a);
      continue;
    }
    programmed[at(a)] = incremental(word->value) ? programmed[at(a)] + value
                        : signs_direction(a)     ? turned_to(a, word->value, value)
                                                 : value;
    if (words.has_factors) add_factor(words, a);
    if (frame.shift_only())
      to[at(a)] = programmed[at(a)] + frame.shift(a);
    else if (frame.separate(a))
      to[at(a)] = frame.to_machine(programmed, a);
    else
      turned = true;
  }
  if (turned)
    for (const int a : {at_.axis1, at_.axis2}) to[at(a)] = frame.to_machine(programmed, a);
  if (words.machine_zero)
    for (int a = 0; a < axes; ++a) programmed[at(a)] = frame.to_programmed(to, a);
  for (int a = 0; a < axes; ++a)
    if (const Word* word = words.axis[at(a)]; word != nullptr || turned)
      frames_.check_axis(a, to[at(a)], word != nullptr ? word->column : column_of(block_, a));
  return to;
}

bool Motion::incremental(const Value& value) const noexcept {
  if (value.dimension != Dimension::as_modes) return value.dimension == Dimension::incremental;
  return modes_.dimension == Function::incremental;
}

void Motion::position(const BlockWords& words, int without_axis) {
  BlockWords rest = words;
  if (without_axis >= 0) rest.axis[at(without_axis)] = nullptr;
  const Position to = target_of(rest);
  if (index(to) && to == at_.machine) return contour_.drop();
  if (at_.zones_active) frames_.check_zones(at_.machine, to, here());
  contour_.drop();
  output_.emit(Rapid{to});
  at_.machine = to;
}

/// Where an axis alone goes; others follow where the plane is turned.
Position Motion::along(int axis, double programmed) {
  at_.programmed[at(axis)] = programmed;
  Position to = at_.machine;
  for (const int a : {axis, at_.axis1, at_.axis2}) {
    if (a != axis && (at_.frame.separate(a) || at_.frame.separate(axis))) continue;
    to[at(a)] = at_.frame.to_machine(at_.programmed, a);
    frames_.check_axis(a, to[at(a)], column_of(block_, a));
  }
  if (at_.zones_active) frames_.check_zones(at_.machine, to, here());
  return to;
}

void Motion::tap(int axis, double programmed, double lead) {
  if (std::abs(at_.programmed[at(axis)] - programmed) < 1e-9) return;
  Thread cut;
  cut.to = along(axis, programmed);
  cut.lead = lead;
  cut.tap = true;
  thread(cut);
}

/// Where several axes go together.
Position Motion::along(const Position& programmed) {
  std::array<bool, image::kMaxAxes> moved{};
  for (int a = 0; a < machine_.axis_count(); ++a) {
    moved[at(a)] = std::abs(at_.programmed[at(a)] - programmed[at(a)]) >= 1e-9;
    if (moved[at(a)]) at_.programmed[at(a)] = programmed[at(a)];
  }
  bool turned = false;
  for (int a = 0; a < machine_.axis_count(); ++a) turned = turned || (moved[at(a)] && !at_.frame.separate(a));
  Position to = at_.machine;
  for (int a = 0; a < machine_.axis_count(); ++a) {
    if (!moved[at(a)] && !(turned && (a == at_.axis1 || a == at_.axis2))) continue;
    to[at(a)] = at_.frame.to_machine(at_.programmed, a);
    frames_.check_axis(a, to[at(a)], column_of(block_, a));
  }
  if (at_.zones_active) frames_.check_zones(at_.machine, to, here());
  return to;
}

void Motion::straight(const Position& to, bool at_rapid, double share, bool rotary) {
  if (at_rapid) {
    output_.emit(Rapid{to});
  } else {
    Line line{to, feed_of(BlockWords{}, 0.0, rotary), CornerRule{}};
    line.feed.value *= share;
    capability_.check_line(BlockWords{}, line);
    output_.emit(line);
  }
  at_.machine = to;
}

void Motion::go(int axis, double programmed, bool at_rapid, double share) {
  if (std::abs(at_.programmed[at(axis)] - programmed) < 1e-9) return;
  straight(along(axis, programmed), at_rapid, share, machine_.rotary(axis));
}

void Motion::go(const Position& programmed, bool at_rapid) {
  const Position to = along(programmed);
  if (to != at_.machine) straight(to, at_rapid, 1.0, false);
}

void Motion::go_round(const Position& programmed, const Position& centre, double sweep_deg) {
  const int a1 = at_.axis1, a2 = at_.axis2;
  const Frame& frame = at_.frame;
  if (std::abs(frame.scale(a1)) != std::abs(frame.scale(a2)))
    fail(Fault::arc_scaled, here(), {machine_.axes[at(a1)].letter, machine_.axes[at(a2)].letter});
  const Point start{at_.machine[at(a1)], at_.machine[at(a2)]};
  Arc arc;
  arc.to = along(programmed);
  arc.axis1 = static_cast<std::uint8_t>(a1);
  arc.axis2 = static_cast<std::uint8_t>(a2);
  arc.center1 = frame.to_machine(centre, a1);
  arc.center2 = frame.to_machine(centre, a2);
  arc.sweep_deg = frame.sense(a1, a2) > 0 ? sweep_deg : -sweep_deg;
  if (at_.zones_active) frames_.check_zones(at_.machine, arc, here());
  const Point end{arc.to[at(a1)], arc.to[at(a2)]}, middle{arc.center1, arc.center2};
  const Box box = extent(start, end, middle, arc.sweep_deg);
  for (const double x : {box.low.x, box.high.x}) frames_.check_axis(a1, x, column_of(block_, a1));
  for (const double y : {box.low.y, box.high.y}) frames_.check_axis(a2, y, column_of(block_, a2));
  const double radius = std::hypot(start.x - middle.x, start.y - middle.y);
  const double length = helix_length(arc, radius);
  arc.feed = feed_of(BlockWords{}, length, false);
  capability_.check_arc(BlockWords{}, arc, radius, length);
  output_.emit(arc);
  at_.machine = arc.to;
}

void Motion::rapid_to(const Position& to) {
  for (int a = 0; a < machine_.axis_count(); ++a)
    if (to[at(a)] != at_.machine[at(a)]) frames_.check_axis(a, to[at(a)], column_of(block_, a));
  if (at_.zones_active) frames_.check_zones(at_.machine, to, here());
  end_profile();
  contour_.drop();
  output_.emit(Rapid{to});
  at_.machine = to;
  for (int a = 0; a < machine_.axis_count(); ++a) at_.programmed[at(a)] = at_.frame.to_programmed(to, a);
}

void Motion::thread(const Position& programmed, double lead, double start_angle_deg) {
  Thread cut;
  cut.to = along(programmed);
  cut.lead = lead;
  cut.start_angle_deg = start_angle_deg;
  thread(cut);
}

void Motion::line(const BlockWords& words, const Position& to) {
  double square = 0.0;
  bool linear = false, turns = false;
  for (int a = 0, axes = machine_.axis_count(); a < axes; ++a) {
    const double delta = to[at(a)] - at_.machine[at(a)];
    square += delta * delta;
    if (delta != 0.0) (machine_.rotary(a) ? turns : linear) = true;
  }
  Line line;
  line.to = to;
  line.feed = feed_of(words, words.time != nullptr ? std::sqrt(square) : 0.0, turns && !linear);
  line.corner = corner_of(words);
  capability_.check_line(words, line);
  give(words, std::move(line), to);
}

void Motion::arc(const BlockWords& words, const Position& to) {
  const int a1 = at_.axis1, a2 = at_.axis2;
  const Frame& frame = at_.frame;
  if (words.machine_zero && !frame.shift_only()) {
    const auto rule = std::find_if(dialect_.g.begin(), dialect_.g.end(),
                                   [](const GRule& g) { return g.function == Function::machine_zero; });
    fail(Fault::machine_zero_arc, here(), {"G" + std::to_string(rule->number)});
  }
  if (std::abs(frame.scale(a1)) != std::abs(frame.scale(a2)))
    fail(Fault::arc_scaled, here(), {machine_.axes[at(a1)].letter, machine_.axes[at(a2)].letter});
  const bool ccw = (modes_.motion == Function::arc_ccw) == (frame.sense(a1, a2) > 0);
  const Point start{at_.machine[at(a1)], at_.machine[at(a2)]}, end{to[at(a1)], to[at(a2)]};
  const Point centre = find_centre(words, start, end, ccw);
  const double r1 = std::hypot(start.x - centre.x, start.y - centre.y);
  const double r2 = std::hypot(end.x - centre.x, end.y - centre.y);
  if (std::abs(r1 - r2) > kRadiusTolerance + 1e-9)
    fail(Fault::not_congruent, here(), {text::number(r1, 4), text::number(r2, 4)});
  if (r1 < 1e-9) fail(Fault::arc_zero, here());

  Arc arc;
  arc.to = to;
  arc.axis1 = static_cast<std::uint8_t>(a1);
  arc.axis2 = static_cast<std::uint8_t>(a2);
  arc.center1 = centre.x;
  arc.center2 = centre.y;
  arc.sweep_deg = sweep(start, end, centre, ccw);
  const double turns = helix_turns(words, to, arc.sweep_deg, r1);
  arc.sweep_deg += arc.sweep_deg < 0.0 ? -360.0 * turns : 360.0 * turns;
  const Box box = extent(start, end, centre, arc.sweep_deg);
  for (const double x : {box.low.x, box.high.x}) frames_.check_axis(a1, x, column_of(block_, a1));
  for (const double y : {box.low.y, box.high.y}) frames_.check_axis(a2, y, column_of(block_, a2));
  const double length = helix_length(arc, r1);
  arc.feed = feed_of(words, length, false);
  arc.corner = corner_of(words);
  capability_.check_arc(words, arc, r1, length);
  give(words, std::move(arc), to);
}

/// F that stays, unless it belongs to its block only (G93).
void Motion::store_feed(const BlockWords& words) {
  if (words.feed == nullptr) return;
  const double value = numbers_.resolve(words.feed->value);
  const LetterRule& rule = dialect_.letters[static_cast<unsigned char>(words.feed->letter)];
  if (!(value >= rule.min - 1e-12 && value <= rule.max))
    numbers_.refuse_range("F", words.feed->value, value, text::number(rule.min).c_str(),
                          text::number(rule.max).c_str());
  if (modes_.feed == Function::feed_inverse) return;
  state_.feed = value;
  state_.feed_unit = modes_.feed;
  state_.feed_at = capability_.written(words.feed->column);
  state_.feed_inch = modes_.unit == Function::inch && !state_.feed_metric;
}

/// What the block asks for is checked in a dry run, too.
Feed Motion::feed_of(const BlockWords& words, double length_mm, bool rotary_only) {
  const Feed programmed = programmed_feed(words, length_mm, rotary_only);
  if (!state_.dry_run || capability_.all_rapids() <= 0.0) return programmed;
  return {capability_.all_rapids() * 60.0, FeedUnit::mm_per_min};
}

Feed Motion::programmed_feed(const BlockWords& words, double length_mm, bool rotary_only) {
  if (words.time != nullptr) {
    const std::string name = letter(Meaning::block_time);
    if (modes_.feed != Function::feed_minute) fail(Fault::block_time, words.time->column, {name});
    const double seconds = numbers_.resolve(words.time->value);
    if (!(seconds > 0.0)) numbers_.refuse_range(name, words.time->value, seconds, "0.001", "99999.999");
    return length_mm > 0.0 ? Feed{length_mm * 60.0 / seconds, FeedUnit::mm_per_min}
                           : Feed{60.0 / seconds, FeedUnit::inverse_time};
  }
  if (modes_.feed == Function::feed_inverse) {
    if (words.feed == nullptr) fail(Fault::feed_inverse, here());
    return {numbers_.resolve(words.feed->value), FeedUnit::inverse_time};
  }
  if (state_.feed <= 0.0 || (dialect_.feed_by_unit && state_.feed_unit != modes_.feed))
    fail(Fault::feed_missing, here());
  const double factor = state_.feed_inch && !rotary_only ? 25.4 : 1.0;
  return {state_.feed * factor,
          modes_.feed == Function::feed_revolution ? FeedUnit::mm_per_rev : FeedUnit::mm_per_min};
}

/// How this element passes into the next one. Source: specification A 13.
CornerRule Motion::corner_of(const BlockWords& words) const {
  CornerRule rule;
  const Function mode = modes_.corner;
  const double tolerance = machine_.contour_tolerance_mm;
  if (mode == Function::exact || words.exact_once || words.dwell) return rule;
  if (mode == Function::continuous) {
    rule.transition = Transition::continuous;
    rule.tolerance_mm = tolerance;
  } else if (state_.corner_error_mm > 0.0) {
    rule.transition = Transition::corner_limited;
    rule.tolerance_mm = std::min(tolerance, state_.corner_error_mm);
    rule.corner_error_mm = state_.corner_error_mm;
    rule.max_angle_deg = state_.max_angle_deg;
  }
  return rule;
}

void Motion::turn_spindle(SpindleMode mode, double share) {
  state_.spindle = mode;
  Spindle spindle;
  spindle.mode = mode;
  spindle.speed = modes_.speed * share;
  spindle.surface_speed = modes_.cutting;
  if (spindle.surface_speed) spindle.limit_rpm = state_.limit_rpm;
  if (spindle.surface_speed && capability_.surface_axis() >= 0)
    spindle.center = at_.frame.length(capability_.surface_axis());
  output_.emit(spindle);
  state_.speed_told = true;
}

void Motion::turn_spindle_by(double degrees) {
  end_profile();
  state_.spindle = SpindleMode::turn;
  Spindle spindle;
  spindle.mode = SpindleMode::turn;
  spindle.speed = modes_.speed;
  spindle.turn_deg = degrees;
  output_.emit(spindle);
}

void Motion::dwell(double seconds) {
  end_profile();
  output_.emit(Dwell{seconds});
}

}  // namespace servogate::program
