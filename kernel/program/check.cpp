// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/program/canon.hpp"
#include "kernel/program/geometry/circle.hpp"
#include "kernel/program/messages.hpp"

namespace servogate::program {
namespace {

constexpr double kOpenTravel = 1e9;
constexpr double kSlack = 1e-6;
constexpr double kSmallestRadius = 0.1;  ///< mm, for the time under a cutting speed
constexpr double kDegree = std::numbers::pi / 180.0;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Follows the commands of a dry run and adds up what a check reports.
class Survey {
 public:
  Survey(const MachineModel& machine, const Position& start, CheckReport& report)
      : machine_(machine), report_(report), position_(start) {
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      CheckReport::Extent extent;
      extent.min = extent.max = start[a];
      extent.travel_min = machine.axes[a].travel_min;
      extent.travel_max = machine.axes[a].travel_max;
      report.extents.push_back(extent);
    }
  }

  void operator()(const Command& command) {
    ++report_.commands;
    line_ = command.line;
    file_ = command.file;
    std::visit([this](const auto& what) { take(what); }, command.what);
  }

  int first_outside() const { return first_outside_; }
  double outside_value() const { return outside_value_; }
  int outside_line() const { return outside_line_; }
  int outside_file() const { return outside_file_; }

 private:
  template <typename Other>
  void take(const Other&) {}
  void take(const Wait&) { ++report_.waits; }
  void take(const Dwell& dwell) { report_.dwell_seconds += dwell.seconds; }
  void take(const Spindle& spindle) { spindle_ = spindle; }
  void take(const Tool& tool) {
    auto known = std::find_if(report_.tools.begin(), report_.tools.end(), [&](const auto& t) {
      return t.number == tool.number && t.corrector == tool.corrector;
    });
    if (known == report_.tools.end())
      known = report_.tools.insert(known, {tool.number, tool.corrector, line_, 0});
    ++known->calls;
  }
  void take(const Rapid& rapid) {
    double seconds = 0.0;
    for (std::size_t a = 0; a < machine_.axes.size(); ++a)
      if (machine_.axes[a].rapid > 0.0)
        seconds = std::max(seconds, std::abs(rapid.to[a] - position_[a]) / machine_.axes[a].rapid);
    report_.rapid_seconds += seconds;
    go(rapid.to);
  }
  void take(const Line& line) {
    double square = 0.0;
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) square += std::pow(line.to[a] - position_[a], 2);
    feed_motion(std::sqrt(square), line.feed, line.to);
    go(line.to);
  }
  void take(const Arc& arc) {
    const auto a1 = at(arc.axis1), a2 = at(arc.axis2);
    const double radius = std::hypot(position_[a1] - arc.center1, position_[a2] - arc.center2);
    double square = std::pow(arc.sweep_deg * kDegree * radius, 2);
    for (std::size_t a = 0; a < machine_.axes.size(); ++a)
      if (a != a1 && a != a2) square += std::pow(arc.to[a] - position_[a], 2);
    feed_motion(std::sqrt(square), arc.feed, arc.to);
    const Box box = extent({position_[a1], position_[a2]}, {arc.to[a1], arc.to[a2]},
                           {arc.center1, arc.center2}, arc.sweep_deg);
    reach(a1, box.low.x), reach(a1, box.high.x), reach(a2, box.low.y), reach(a2, box.high.y);
    go(arc.to);
  }

  /// Speed of the spindle on the way to `to`; under a cutting speed that at half of the way.
  double rpm(const Position& to) const {
    double rpm = spindle_.speed;
    const auto x =
        std::find_if(machine_.axes.rbegin(), machine_.axes.rend(), [](const auto& a) { return a.diameter; });
    if (spindle_.surface_speed) {
      if (x == machine_.axes.rend()) return 0.0;
      const auto axis = static_cast<std::size_t>(machine_.axes.rend() - x) - 1;
      const double radius = std::abs(0.5 * (position_[axis] + to[axis]) - spindle_.center);
      rpm = spindle_.speed * 1000.0 / (2.0 * std::numbers::pi * std::max(radius, kSmallestRadius));
    }
    if (machine_.spindle_max_rpm > 0.0) rpm = std::min(rpm, machine_.spindle_max_rpm);
    return rpm > 0.0 ? std::max(rpm, machine_.spindle_min_rpm) : 0.0;
  }

  void feed_motion(double length, const Feed& feed, const Position& to) {
    report_.path_mm += length;
    double minutes = 0.0;
    if (feed.unit == FeedUnit::mm_per_min) minutes = length / feed.value;
    if (feed.unit == FeedUnit::inverse_time) minutes = 1.0 / feed.value;
    if (feed.unit == FeedUnit::mm_per_rev)
      if (const double turns = rpm(to); turns > 0.0) minutes = length / (feed.value * turns);
    report_.feed_seconds += minutes * 60.0;
  }

  void reach(std::size_t axis, double value) {
    CheckReport::Extent& extent = report_.extents[axis];
    if (value != position_[axis]) extent.moved = true;
    extent.min = std::min(extent.min, value);
    extent.max = std::max(extent.max, value);
    const bool outside = value > extent.travel_max + kSlack || value < extent.travel_min - kSlack;
    if (!outside || extent.outside_line != 0) return;
    extent.outside_line = line_;
    extent.outside_file = file_;
    if (first_outside_ >= 0) return;
    first_outside_ = static_cast<int>(axis);
    outside_value_ = value;
    outside_line_ = line_;
    outside_file_ = file_;
  }

  void go(const Position& to) {
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) reach(a, to[a]);
    position_ = to;
  }

  const MachineModel& machine_;
  CheckReport& report_;
  Position position_;
  Spindle spindle_;
  int line_ = 0, file_ = 0;
  int first_outside_ = -1, outside_line_ = 0, outside_file_ = 0;
  double outside_value_ = 0.0;
};

MachineModel without_travel(MachineModel machine) {
  for (auto& axis : machine.axes) {
    axis.travel_min = -kOpenTravel;
    axis.travel_max = kOpenTravel;
  }
  return machine;
}

void add_travel(CheckReport& report, const Interpreter& interpreter, const MachineModel& machine,
                const Survey& survey) {
  if (survey.first_outside() < 0) return;
  const auto& axis = machine.axes[at(survey.first_outside())];
  const double limit = survey.outside_value() > axis.travel_max ? axis.travel_max : axis.travel_min;
  report.findings.push_back(
      {text::Severity::error,
       interpreter.path(survey.outside_file()),
       survey.outside_line(),
       interpreter.column(survey.outside_file(), survey.outside_line(), survey.first_outside()),
       &entry(Fault::travel),
       {axis.letter, text::number(survey.outside_value(), 4), text::number(limit, 4)}});
}

}  // namespace

bool CheckReport::good() const {
  return finished && std::none_of(findings.begin(), findings.end(),
                                  [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

CheckReport check_program(std::string_view dialect, const MachineModel& machine, const Tables& tables,
                          const std::string& file_name, const std::string& text, const ProgramLoader& loader,
                          const Position& start) {
  CheckReport report;
  Interpreter interpreter(dialect, without_travel(machine), tables, file_name, text, loader, start);
  report.findings = interpreter.findings();
  report.blocks = interpreter.block_count();
  Survey survey(machine, start, report);
  const auto on_command = [&](const Command& command) {
    survey(command);
    return true;
  };
  const auto error = run_dry(interpreter, on_command, kDryRunBlocks + report.blocks);
  report.executed = interpreter.executed();
  report.files = interpreter.files();
  report.finished = !error;
  const std::vector<text::Finding>& warnings = interpreter.warnings();
  report.findings.insert(report.findings.end(), warnings.begin(), warnings.end());
  add_travel(report, interpreter, machine, survey);
  const auto same = [&](const text::Finding& f) {
    return f.file == error->file && f.line == error->line && f.entry == error->entry;
  };
  if (error && std::none_of(report.findings.begin(), report.findings.end(), same))
    report.findings.push_back(*error);
  return report;
}

}  // namespace servogate::program
