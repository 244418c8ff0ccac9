// SPDX-License-Identifier: Apache-2.0
// A start in the middle of a program: the state before the block is computed, shown, and taken up.
#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

using Entry = text::Entry;
const Entry kNotInterrupted{"restart.not-interrupted",
                            "no program was interrupted: give the block with --from N120 or --line 57",
                            "прерванной программы нет: задайте кадр ключом --from N120 или --line 57"};
const Entry kOtherProgram{"restart.other-program",
                          "the program that was interrupted is {0}: load it first (`servogate load {0}`)",
                          "прервана была программа {0}: сначала загрузите её (`servogate load {0}`)"};
const Entry kNoBlockYet{"restart.no-block-yet",
                        "it was interrupted before its first block: `servogate start`",
                        "программа прервана до первого кадра: `servogate start`"};
const Entry kFeed{"restart.feed", "the feed of the way there is {0} to {1} mm/min",
                  "подача на подходе — от {0} до {1} мм/мин"};
const Entry kOneWay{"restart.one-way", "give one of line and number, and a whole one from 0 on",
                    "задайте что-то одно из line и number, целым числом от 0"};
const Entry kOtherTool{"restart.other-tool",
                       "the block works with tool {0}, and tool {1} is in the spindle: change it first",
                       "кадр работает с инструментом {0}, а в шпинделе {1}: сначала смените его"};
const Entry kPlanned{"said.restart-planned", "the program can begin at line {0}",
                     "программу можно начать со строки {0}"};
const Entry kBegun{"said.restart-begun", "{0} begins at line {1}", "{0} начинается со строки {1}"};
const Entry kStepSpindle{"restart.step-spindle", "spindle {0} at {1} {2}", "шпиндель {0}, {1} {2}"};
const Entry kStepCoolant{"restart.step-coolant", "M{0}", "M{0}"};
const Entry kStepPlane{"restart.step-plane", "{0} at {1} mm/min", "{0} с подачей {1} мм/мин"};

std::string joined(std::string list, const std::string& more) {
  return list.empty() ? more : list + ", " + more;
}

}  // namespace

Outcome Dispatch::take(const ask::Restart& wanted) {
  const int process = wanted.process;
  if (!process_known(process)) return refusal_;
  if (resident_.busy(process)) return busy(process);
  const bool bad =
      (wanted.line && wanted.number) || wanted.line.value_or(1) < 1 || wanted.number.value_or(0) < 0;
  if (bad) return fail(kOneWay, {}, kWrongUse);
  if (!(wanted.feed_mm_min >= kSlowestWay && wanted.feed_mm_min <= kFastestWay))
    return fail(kFeed, {text::number(kSlowestWay), text::number(kFastestWay)}, kWrongUse);
  program::RestartAt at;
  if (wanted.line) {
    at = {program::RestartAt::By::line, *wanted.line};
  } else if (wanted.number) {
    at = {program::RestartAt::By::number, *wanted.number};
  } else {
    const auto block = resident_.interrupted(process);
    if (!block) return fail(kNotInterrupted, {}, kAlarm);
    if (block->program != resident_.program(process)) return fail(kOtherProgram, {block->program}, kAlarm);
    if (block->executed < 1) return fail(kNoBlockYet, {}, kAlarm);
    at = {program::RestartAt::By::executed, block->executed};
  }
  if (auto why = not_ready(process)) return std::move(*why);
  const auto search = std::make_shared<Resident::RestartSearch>(resident_.begin_restart(process, at));
  Resident& resident = resident_;
  Work work;
  work.what = "restart", work.name = search->file->path;
  work.run = [&resident, &plc = plc_, search, wanted,
              question = question_](const std::stop_token&) -> Finish {
    Resident::find(*search);
    return [&resident, &plc, search, wanted, question]() -> Outcome {
      return Dispatch(resident, plc, question).found(*search, wanted);
    };
  };
  return work;
}

RestartReport Dispatch::report_of(const Resident::RestartSearch& search, const ask::Restart& wanted) {
  const auto& point = std::get<program::RestartPoint>(*search.found);
  RestartReport r;
  r.line = point.line;
  r.executed = point.executed;
  r.file = point.interpreter.path(point.file);
  r.text = resident_.line_of(search.process, r.file, point.line);
  r.tool = point.tool;
  r.corrector = point.corrector;
  r.spindle = point.spindle;
  if (point.coolant) r.coolant = point.coolant->code;
  for (const program::MFunction& m : point.passed) r.passed.push_back(m.code);
  r.writes = point.writes;
  r.signals = point.signals;
  const auto block = resident_.interrupted(search.process);
  r.from_disk = block && block->from_disk;
  const image::ProcessImage& now = resident_.image();
  r.asked_s = now.now.seconds();
  const bool where_interrupted = !wanted.line && !wanted.number && block;
  double overlap = 0.0;
  std::string plane, depth;
  for (int a = 0; a < static_cast<int>(machine().program_axes()); ++a) {
    const machine::AxisConfig& config = axis_config(a);
    if (now.axes[static_cast<std::size_t>(a)].process != search.process) continue;
    const double shown = config.diameter ? 2.0 : 1.0;
    r.axes.push_back({config.letter, config.unit(), now.axes[static_cast<std::size_t>(a)].command * shown,
                      point.position[static_cast<std::size_t>(a)] * shown});
    if (where_interrupted && config.type == machine::AxisType::linear)
      overlap = std::hypot(
          overlap, block->stands[static_cast<std::size_t>(a)] - point.position[static_cast<std::size_t>(a)]);
    if (std::abs(r.axes.back().stands - r.axes.back().begins) < 1e-6) continue;
    const std::string way = config.letter + " " + text::number(r.axes.back().begins, 4);
    if (a == point.depth_axis)
      depth = way;
    else
      plane = joined(plane, way);
  }
  if (where_interrupted) r.overlap_mm = overlap;
  const auto say = [&](const Entry& entry, const std::vector<std::string>& arguments) {
    r.steps.push_back(text::render(entry, arguments, language_));
  };
  if (r.spindle)
    say(kStepSpindle,
        {r.spindle->mode == program::SpindleMode::ccw ? "M4" : "M3", text::number(r.spindle->speed, 1),
         text::unit_words(r.spindle->surface_speed ? "m/min" : "rpm")});
  if (r.coolant) say(kStepCoolant, {std::to_string(*r.coolant)});
  for (const std::string& way : {plane, depth})
    if (!way.empty()) say(kStepPlane, {way, text::number(wanted.feed_mm_min)});
  return r;
}

Outcome Dispatch::found(const Resident::RestartSearch& search, const ask::Restart& wanted) {
  if (const auto* wrong = std::get_if<text::Finding>(&*search.found)) {
    Reply refused = fail(*wrong->entry, wrong->arguments, kAlarm);
    refused.text = wrong->str(language_);
    return refused;
  }
  const int process = search.process;
  if (resident_.busy(process)) return busy(process);
  RestartReport report = report_of(search, wanted);
  const std::int32_t in_spindle = resident_.image().processes[static_cast<std::size_t>(process)].tool;
  if (report.tool != 0 && report.tool != in_spindle)
    return fail(kOtherTool, {std::to_string(report.tool), std::to_string(in_spindle)}, kAlarm);
  const std::string line = std::to_string(report.line);
  if (wanted.plan) return good(kPlanned, {line}, std::move(report));
  if (!resident_.begin_in_middle(search, wanted.feed_mm_min, wanted.confirm)) return busy(process);
  if (!ask(RequestKind::start, -1, 0.0, image::Mode::automatic, process)) {
    resident_.take_tables(process);  // the next start is the whole program's again
    return refusal_;
  }
  return good(kBegun, {resident_.program(process), line}, std::move(report));
}

}  // namespace servogate::gateway
