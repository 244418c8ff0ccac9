// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/interpreter/restart.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::program {

namespace {

constexpr long long kMostCalls = 50'000'000;  ///< of next(); a program that needs more has lost its way
constexpr int kCoolant[] = {7, 8, 9};         ///< ISO 6983: coolant on, on, off
constexpr int kCoolantOff = 9;
constexpr int kSpindle[] = {3, 4, 5, 19};  ///< the same: cw, ccw, stop, orient
constexpr double kStands = 1e-6;           ///< mm or degrees

const text::Entry kNotReached{"restart.not-reached", "the program has no block {0} that does anything",
                              "в программе нет кадра {0}, который что-либо выполняет"};
const text::Entry kProbes{"restart.probes",
                          "before {0} the program measures: what it found is not known any more",
                          "до {0} программа выполняет измерение: его результат уже неизвестен"};

const text::Entry kProcesses{
    "restart.processes",
    "before {0} the program starts or waits for other processes: where they stand is not known",
    "до {0} программа запускает или ждёт другие процессы: где они находятся, неизвестно"};

std::string words(const RestartAt& at) {
  switch (at.by) {
    case RestartAt::By::line:
      return text::both("line " + std::to_string(at.value), "строка " + std::to_string(at.value));
    case RestartAt::By::number:
      return "N" + std::to_string(at.value);
    case RestartAt::By::executed:
      break;
  }
  return text::both("executed block " + std::to_string(at.value),
                    "выполненный кадр " + std::to_string(at.value));
}

text::Finding finding(const Interpreter& program, const text::Entry& entry, const RestartAt& at, int line) {
  return {text::Severity::error, program.path(0), std::max(line, 1), 1, &entry, {words(at)}};
}

/// Follows the commands of a program and keeps what has to be restored.
class Survey {
 public:
  /// False: behind this command nothing can be told.
  bool take(const Command& command) {
    if (const auto* s = std::get_if<Spindle>(&command.what)) spindle(*s);
    if (const auto* m = std::get_if<MFunction>(&command.what)) function(*m);
    if (const auto* t = std::get_if<Tool>(&command.what)) tool = *t;
    if (const auto* w = std::get_if<InPosition>(&command.what)) window(*w);
    if (const auto* o = std::get_if<FeedOverride>(&command.what)) override_effective = o->effective;
    if (std::holds_alternative<WritePlace>(command.what)) ++writes;
    const auto* coupling = std::get_if<SpindleCoupling>(&command.what);
    if (coupling != nullptr && coupling->on) return false;
    if (const auto* axis = std::get_if<SpindleAxis>(&command.what); axis != nullptr && axis->on) return false;
    return !std::holds_alternative<Probe>(command.what) &&
           !std::holds_alternative<ProcessOrder>(command.what);
  }

  std::optional<Spindle> turning;
  std::optional<MFunction> spindle_function, coolant;
  Tool tool;
  InPosition windows;
  bool override_effective = true;
  std::vector<MFunction> passed;
  int writes = 0;

 private:
  void window(const InPosition& w) {
    windows.axes |= w.axes;
    for (std::size_t a = 0; a < w.window.size(); ++a)
      if ((w.axes >> a & 1u) != 0) windows.window[a] = w.window[a];
  }
  void spindle(const Spindle& s) {
    if (s.mode == SpindleMode::stop || s.mode == SpindleMode::orient || s.mode == SpindleMode::turn) {
      turning.reset();
      return;
    }
    if (s.mode == SpindleMode::keep && !turning) return;
    const SpindleMode mode = s.mode == SpindleMode::keep ? turning->mode : s.mode;
    turning = s;
    turning->mode = mode;
  }
  void function(const MFunction& m) {
    if (std::find(std::begin(kCoolant), std::end(kCoolant), m.code) != std::end(kCoolant)) {
      coolant = m.code == kCoolantOff ? std::nullopt : std::optional(m);
      return;
    }
    if (std::find(std::begin(kSpindle), std::end(kSpindle), m.code) != std::end(kSpindle)) {
      spindle_function = m.code < 5 ? std::optional(m) : std::nullopt;
      return;
    }
    std::erase_if(passed, [&](const MFunction& other) { return other.code == m.code; });
    passed.push_back(m);
  }
};

bool is_target(const RestartAt& at, const Command& command, long long executed) {
  switch (at.by) {
    case RestartAt::By::line:
      return command.file == 0 && command.line == at.value;
    case RestartAt::By::number:
      return command.file == 0 && command.block == at.value;
    case RestartAt::By::executed:
      break;
  }
  return executed >= at.value;
}

}  // namespace

/// The target is met only when its first command comes, so the program runs twice: once to find it, and once
/// to the call of next() before it.
std::variant<RestartPoint, text::Finding> restart(const Interpreter& fresh, const RestartAt& at,
                                                  const image::Packets& packets) {
  Interpreter search(fresh);
  search.set_switches(at.switches);
  Survey survey;
  long long calls = 0;
  Command target;
  for (;; ++calls) {
    Step step = search.next(packets, true);
    if (const auto* error = std::get_if<Error>(&step)) return error->finding;
    if (std::holds_alternative<NeedsSync>(step)) {
      if (calls > kMostCalls) return finding(search, kNotReached, at, 1);
      continue;
    }
    const Command& command = std::get<Command>(step);
    if (is_target(at, command, search.executed())) {
      target = command;
      break;
    }
    if (std::holds_alternative<End>(command.what) || calls > kMostCalls)
      return finding(search, kNotReached, at, command.line);
    if (!survey.take(command))
      return finding(search, std::holds_alternative<Probe>(command.what) ? kProbes : kProcesses, at,
                     command.line);
  }
  Interpreter before(fresh);
  before.set_switches(at.switches);
  for (long long call = 0; call < calls; ++call) before.next(packets, true);
  RestartPoint point{before};
  point.line = target.line;
  point.file = target.file;
  point.executed = before.executed();
  point.position = before.position();
  point.depth_axis = before.depth_axis();
  point.spindle = survey.turning;
  point.spindle_function = survey.spindle_function;
  point.coolant = survey.coolant;
  point.windows = survey.windows;
  point.override_effective = survey.override_effective;
  point.tool = survey.tool.number;
  point.corrector = survey.tool.corrector;
  point.passed = std::move(survey.passed);
  point.writes = survey.writes;
  point.signals = before.machine_read();
  return point;
}

std::vector<Command> approach(const RestartPoint& point, const Position& stands, double feed_mm_min,
                              bool confirm) {
  std::vector<Command> commands;
  const auto add = [&](auto what) {
    Command c;
    c.line = point.line;
    c.file = point.file;
    c.what = std::move(what);
    commands.push_back(std::move(c));
  };
  const auto ask = [&] {
    if (confirm) add(Stop{});
  };
  const auto go = [&](const Position& to) {
    Line line;
    line.to = to;
    line.feed = {feed_mm_min, FeedUnit::mm_per_min};
    line.corner.transition = Transition::exact_stop;
    add(line);
  };
  const auto differs = [](const Position& a, const Position& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::abs(a[i] - b[i]) > kStands) return true;
    return false;
  };
  if (point.windows.axes != 0) add(point.windows);
  if (point.spindle || point.coolant) ask();
  if (point.spindle) add(*point.spindle);
  if (point.spindle && point.spindle_function) add(*point.spindle_function);
  if (point.coolant) add(*point.coolant);
  Position over = point.position;
  if (point.depth_axis >= 0) {
    const auto depth = static_cast<std::size_t>(point.depth_axis);
    over[depth] = stands[depth];
  }
  if (differs(stands, over)) {
    ask();
    go(over);
  }
  if (differs(over, point.position)) {
    ask();
    go(point.position);
  }
  if (!point.override_effective) add(FeedOverride{false});
  return commands;
}

}  // namespace servogate::program
