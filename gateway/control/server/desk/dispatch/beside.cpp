// SPDX-License-Identifier: Apache-2.0
// Work beside a held program: typed functions, and the way back of axes that were jogged away.
#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

using Entry = text::Entry;
const Entry kReturns{"said.returns", "the axes return to the path by the way that they went",
                     "оси возвращаются на контур тем же путём"};
constexpr double kFarthestBack = 1e6;  // mm
constexpr double kMostBlocks = 1e6;
const Entry kReturnFeed{"return.feed", "the feed of the way back is {0} to {1} mm/min",
                        "подача на возврате — от {0} до {1} мм/мин"};
const Entry kRetraces{"said.retraces", "the axes go back along the path of the program",
                      "оси идут назад по контуру программы"};
const Entry kRetraceBy{
    "retrace.by", "say how far back: above 0 to {0} mm, or 1 to {1} blocks, and not both",
    "укажите, на сколько назад: больше 0 и до {0} мм или от 1 до {1} кадров, одно из двух"};
const Entry kFunctionsRun{"said.functions-run", "{0} is executed beside the held program",
                          "{0} выполняется; программа остаётся приостановленной"};
const Entry kOnlyFunctions{
    "beside.only-functions",
    "a program is held: M, S and T functions can be typed beside it, and this block does more; `servogate "
    "reset` ends the program, `servogate start --interrupted` goes on with it later",
    "программа приостановлена: рядом с ней можно вводить только функции M, S и T, а этот кадр делает больше; "
    "`servogate reset` завершает программу, `servogate start --interrupted` продолжит её позже"};
const Entry kNoFunction{"beside.no-function",
                        "a program is held, and this block has no M, S or T function to be executed",
                        "программа приостановлена, а в кадре нет функций M, S или T"};
const Entry kNoSpeed{"beside.no-speed", "the spindle needs its speed in the same block, as M3 S1000",
                     "шпинделю нужна частота в том же кадре, например M3 S1000"};
const Entry kStands{"beside.spindle-stands", "the spindle stands: M3 or M4 turns it",
                    "шпиндель стоит: его включает M3 или M4"};

const Entry kWheelChosen{"said.path-wheel", "the program follows its handwheel along the path",
                         "программа следует маховичку по контуру"};
const Entry kWheelLeft{"said.path-wheel-left",
                       "the program does not follow its handwheel any more; one that runs is held",
                       "программа больше не следует маховичку; выполняемая приостановлена"};
const Entry kWheelTold{"said.path-wheel-told", "the handwheel of the path is heard",
                       "сообщение маховичка принято"};

image::Request function(image::Function what, double value) {
  image::Request r;
  r.kind = RequestKind::function;
  r.index = static_cast<std::uint32_t>(what);
  r.value = value;
  return r;
}

}  // namespace

/// A command of a typed block as a request; nullptr with `problem`: it is none.
const text::Entry* Dispatch::function_of(const program::Command& command, int process,
                                         std::optional<image::Request>& request) {
  using Mode = program::SpindleMode;
  using image::Function;
  if (const auto* m = std::get_if<program::MFunction>(&command.what)) {
    request = function(Function::m, m->code);
  } else if (const auto* tool = std::get_if<program::Tool>(&command.what)) {
    if (tool->corrector > 255) return &kOnlyFunctions;
    request = function(Function::tool, tool->number);
    request->format = static_cast<std::uint8_t>(tool->corrector);
  } else if (const auto* s = std::get_if<program::Spindle>(&command.what)) {
    Mode mode = s->mode;
    if (s->surface_speed || mode == Mode::orient) return &kOnlyFunctions;
    if (mode == Mode::keep) {
      const machine::SpindleConfig* spindle = machine().spindle_of_process(process);
      const double rpm = spindle == nullptr
                             ? 0.0
                             : resident_.image()
                                   .spindles[static_cast<std::size_t>(spindle - machine().spindles.data())]
                                   .command_rpm;
      if (rpm == 0.0) return &kStands;
      mode = rpm > 0.0 ? Mode::cw : Mode::ccw;
    }
    if (mode != Mode::stop && s->speed <= 0.0) return &kNoSpeed;
    request = function(mode == Mode::cw    ? Function::spindle_clockwise
                       : mode == Mode::ccw ? Function::spindle_counterclockwise
                                           : Function::spindle_stop,
                       mode == Mode::stop ? 0.0 : s->speed);
    request->packet = s->number;
  } else if (!std::holds_alternative<program::Message>(command.what)) {
    return &kOnlyFunctions;
  }
  return nullptr;
}

Outcome Dispatch::functions(const ask::Mdi& wanted) {
  const Resident::TriedBlock tried = resident_.try_block(wanted.process, wanted.block);
  if (tried.failed()) return fail(says::kBlockWrong, {tried.findings.back().str(language_)}, kAlarm);
  std::vector<image::Request> requests;
  for (const program::Command& command : tried.commands) {
    std::optional<image::Request> request;
    if (const text::Entry* problem = function_of(command, wanted.process, request))
      return fail(*problem, {}, kAlarm);
    if (request) requests.push_back(*request);
  }
  if (requests.empty()) return fail(kNoFunction, {}, kAlarm);
  for (image::Request& r : requests) {
    r.process = static_cast<std::int8_t>(wanted.process);
    if (!ask(r)) return refusal_;
  }
  return good(kFunctionsRun, {wanted.block}, FunctionsBegun{});
}

Outcome Dispatch::take(const ask::Return& wanted) {
  if (!process_known(wanted.process)) return refusal_;
  if (wanted.feed_mm_min && !(*wanted.feed_mm_min >= kSlowestWay && *wanted.feed_mm_min <= kFastestWay))
    return fail(kReturnFeed, {text::number(kSlowestWay), text::number(kFastestWay)}, kWrongUse);
  image::Request r;
  r.kind = RequestKind::reposition;
  r.process = static_cast<std::int8_t>(wanted.process);
  r.velocity = wanted.feed_mm_min.value_or(0.0) / 60.0;
  return ask(r) ? good(kReturns) : refusal_;
}

Outcome Dispatch::take(const ask::PathWheel& wanted) {
  using What = ask::PathWheel::What;
  using image::WheelNews;
  if (!process_known(wanted.process)) return refusal_;
  const bool chooses = wanted.what == What::choose || wanted.what == What::leave;
  image::Request r;
  r.kind = RequestKind::path_wheel;
  r.process = static_cast<std::int8_t>(wanted.process);
  r.index = static_cast<std::uint32_t>(chooses                       ? WheelNews::choose
                                       : wanted.what == What::turned ? WheelNews::turned
                                                                     : WheelNews::here);
  r.value = wanted.what == What::turned                                ? wanted.counts
            : wanted.what == What::choose || wanted.what == What::here ? 1.0
                                                                       : 0.0;
  if (!ask(r)) return refusal_;
  return good(!chooses ? kWheelTold : wanted.what == What::choose ? kWheelChosen : kWheelLeft);
}

Outcome Dispatch::take(const ask::Retrace& wanted) {
  if (!process_known(wanted.process)) return refusal_;
  const bool by_way = wanted.mm && *wanted.mm > 0.0 && *wanted.mm <= kFarthestBack;
  const bool by_blocks = wanted.blocks && *wanted.blocks >= 1.0 && *wanted.blocks <= kMostBlocks &&
                         *wanted.blocks == std::floor(*wanted.blocks);
  if (wanted.mm.has_value() == wanted.blocks.has_value() || by_way == by_blocks)
    return fail(kRetraceBy, {text::number(kFarthestBack), text::number(kMostBlocks)}, kWrongUse);
  if (wanted.feed_mm_min && !(*wanted.feed_mm_min >= kSlowestWay && *wanted.feed_mm_min <= kFastestWay))
    return fail(kReturnFeed, {text::number(kSlowestWay), text::number(kFastestWay)}, kWrongUse);
  image::Request r;
  r.kind = RequestKind::retrace;
  r.process = static_cast<std::int8_t>(wanted.process);
  r.value = wanted.mm.value_or(0.0);
  r.index = static_cast<std::uint32_t>(wanted.blocks.value_or(0.0));
  r.velocity = wanted.feed_mm_min.value_or(0.0) / 60.0;
  return ask(r) ? good(kRetraces) : refusal_;
}

}  // namespace servogate::gateway
