// SPDX-License-Identifier: Apache-2.0
// A place that is measured by hand: tool setter, edge of the workpiece.
#include <algorithm>
#include <cmath>

#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "kernel/channel/motion/touch.hpp"

namespace servogate::gateway {

namespace {

using text::Entry;

constexpr double kMostTimes = 50.0, kFarthest = 1e4, kSlowest = 0.1;

const Entry kNoProbe{"touch.no-probe",
                     "the machine has no probe: name its input in the machine file (`probe` in [control])",
                     "на станке нет щупа: укажите его вход в файле станка (`probe` в [control])"};
const Entry kRotary{"touch.rotary", "{0} is a rotary axis: a touch is measured along a linear one",
                    "{0} — поворотная ось: касание измеряется вдоль линейной"};
const Entry kRange{"touch.range", "{0} is {1}: it is {2} to {3}", "{0} равно {1}: допускается от {2} до {3}"};
const Entry kTravel{"touch.travel", "{0} would go to {1} mm (machine coordinates): its travel ends at {2} mm",
                    "{0} пошла бы до {1} мм (в координатах станка): её ход кончается на {2} мм"};
const Entry kPlan{
    "touch.plan",
    "{0} goes from {1} to {2} mm at most (machine coordinates): at {3} mm/min to the first touch, "
    "behind which it stops within {4} mm, then {5} at {6} mm/min from {7} mm back, and back to {1} mm",
    "{0} идёт от {1} не дальше {2} мм (в координатах станка): с {3} мм/мин до первого касания, за "
    "которым останавливается в пределах {4} мм, затем {5} с {6} мм/мин, отходя на {7} мм, и назад на "
    "{1} мм"};
const Entry kBegun{"touch.begun", "{0} measures", "{0} измеряет"};

std::string mm(double value) { return text::number(value, 4); }

}  // namespace

/// What is wrong with the figures of the order, nullopt: nothing.
std::optional<Reply> Dispatch::wrong_touch(const ask::Touch& wanted, const machine::AxisConfig& a) const {
  const double fastest = a.max_velocity * 60.0;
  const struct {
    const char* name;
    double value, least, most;
  } rows[] = {{"by", std::abs(wanted.by), 1e-3, kFarthest},
              {"feed", wanted.feed_mm_min, kSlowest, fastest},
              {"slow", wanted.slow_mm_min, kSlowest, std::min(fastest, wanted.feed_mm_min)},
              {"back", wanted.back, 0.01, std::abs(wanted.by)},
              {"times", wanted.times, 1.0, kMostTimes}};
  for (const auto& row : rows)
    if (!(row.value >= row.least && row.value <= row.most))
      return fail(kRange, {row.name, mm(row.value), mm(row.least), mm(row.most)}, kWrongUse);
  if (wanted.times != std::floor(wanted.times))
    return fail(kRange, {"times", mm(wanted.times), "1", mm(kMostTimes)}, kWrongUse);
  return std::nullopt;
}

Outcome Dispatch::take(const ask::Touch& wanted) {
  const int index = axis(wanted.axis);
  if (index < 0) return refusal_;
  const machine::AxisConfig& a = axis_config(index);
  if (machine().control.probe.empty()) return fail(kNoProbe, {}, kWrongUse);
  if (a.type == machine::AxisType::rotary) return fail(kRotary, {a.letter}, kWrongUse);
  if (auto wrong = wrong_touch(wanted, a)) return std::move(*wrong);
  const int process = process_of(index);
  if (resident_.busy(process)) return busy(process);
  const double across = a.diameter ? 2.0 : 1.0;
  const double from = resident_.image().axes[static_cast<std::size_t>(index)].command;
  const double end = from + wanted.by / across;
  if (!a.endless() && (end < a.travel_min || end > a.travel_max))
    return fail(kTravel,
                {a.letter, mm(end * across), mm((end < a.travel_min ? a.travel_min : a.travel_max) * across)},
                kWrongUse);
  if (wanted.plan) {
    const double v = wanted.feed_mm_min / 60.0;
    const double stops = v * v / (2.0 * a.max_acceleration) + v * a.max_acceleration / (2.0 * a.max_jerk) +
                         v * 4.0 * machine().control.cycle_time;
    const std::string times = text::number(wanted.times);
    return good(kPlan, {a.letter, mm(from * across), mm(end * across), mm(wanted.feed_mm_min), mm(stops),
                        text::both(times + (wanted.times > 1.0 ? " touches" : " touch"), times + " кас."),
                        mm(wanted.slow_mm_min), mm(wanted.back)});
  }
  if (auto proof = resident_.take_tables(process)) return behind(std::move(*proof));
  resident_.set_touch(process, a.letter,
                      {index, wanted.by / across, wanted.feed_mm_min, wanted.slow_mm_min, wanted.back / across,
                       static_cast<std::int32_t>(wanted.times)});
  if (ask(RequestKind::start, -1, 0.0, image::Mode::mdi, process)) return good(kBegun, {a.letter});
  resident_.set_manual_block(process, {});  // a start button must not find it later
  return refusal_;
}

}  // namespace servogate::gateway
