// SPDX-License-Identifier: Apache-2.0
#include "machine/check/stops/overrun.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/consequences.hpp"

namespace servogate::machine {

namespace {

constexpr double kCyclesToReact = 3.0;  // the input is read, answered and obeyed

/// An axis that does not know where it is keeps to these speeds; a homed one keeps away from its switches.
double velocity_not_homed(const AxisConfig& a) {
  const HomingConfig& h = a.home;
  double v = a.jog_not_homed();
  if (h.method != HomingMethod::none && h.method != HomingMethod::absolute) v = std::max({v, h.fast, h.slow});
  return v;
}

/// Greatest speed from which latency and stop fit into `room`.
double speed_for(double room, double unseen, const AxisConfig& a) {
  double low = 0.0, high = 1e6;
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2.0;
    const double way = middle * unseen + stop_from(middle, a.max_acceleration, a.max_jerk).way;
    (way <= room ? low : high) = middle;
  }
  return low;
}

void check_side(const LoadResult& loaded, std::size_t index, bool plus, Reading& reading) {
  const AxisConfig& a = loaded.machine.axes[index];
  const std::string key = plus ? "mechanical_end_plus" : "mechanical_end_minus";
  const double end = plus ? a.mechanical_end_plus : a.mechanical_end_minus;
  if (!std::isfinite(end) || a.endless()) return;
  const Where at = loaded.machine.where("axis." + std::to_string(index) + "." + key);
  const auto length = [&a](double v) { return text::number(v, 3) + " " + text::unit_words(a.unit()); };
  const double sign = plus ? 1.0 : -1.0;
  const double hard = plus ? a.hard_limit_plus : a.hard_limit_minus;
  const double within = std::isfinite(hard) ? hard : plus ? a.travel_max : a.travel_min;
  if ((end - within) * sign <= 0.0)
    return reading.error(at, finding::kEndInside, {a.letter, key, length(end), length(within)});
  const auto o = overrun(loaded, a, plus);
  if (!o || o->way <= o->room) return;
  const std::string per_second = " " + text::unit_words(a.speed_unit());
  reading.error(at, finding::kEndTooNear,
                {a.letter, plus ? "+" : "-", length(o->room), text::number(o->velocity, 3) + per_second,
                 length(o->way), text::number(std::floor(o->safe_velocity * 10.0) / 10.0) + per_second});
}

}  // namespace

Stop stop_from(double v, double a, double j) {
  const double time = v * j >= a * a ? v / a + a / j : 2.0 * std::sqrt(v / j);
  return {v * time / 2.0, time};
}

std::optional<Overrun> overrun(const LoadResult& loaded, const AxisConfig& a, bool plus) {
  const double end = plus ? a.mechanical_end_plus : a.mechanical_end_minus;
  const double hard = plus ? a.hard_limit_plus : a.hard_limit_minus;
  int station = -1;
  const PointConfig* point = loaded.machine.point(plus ? a.limit_plus : a.limit_minus, &station);
  if (point == nullptr || !std::isfinite(end) || !std::isfinite(hard) || a.max_acceleration <= 0.0 ||
      a.max_jerk <= 0.0 || a.endless())
    return std::nullopt;
  Overrun o;
  o.room = std::max(0.0, plus ? end - hard : hard - end);
  o.unseen = read_every(loaded, loaded.machine.stations[static_cast<std::size_t>(station)]) +
             point->debounce + kCyclesToReact * loaded.machine.control.cycle_time;
  o.velocity = velocity_not_homed(a);
  o.way = o.velocity * o.unseen + stop_from(o.velocity, a.max_acceleration, a.max_jerk).way;
  o.safe_velocity = speed_for(o.room, o.unseen, a);
  return o;
}

void check_overrun(const LoadResult& loaded, Reading& reading) {
  for (std::size_t i = 0; i < loaded.machine.axes.size(); ++i)
    for (const bool plus : {false, true}) check_side(loaded, i, plus, reading);
}

}  // namespace servogate::machine
