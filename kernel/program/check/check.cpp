// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check/check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/geometry/circle.hpp"

namespace servogate::program {
namespace {

constexpr double kOpenTravel = 1e9;
constexpr double kSlack = 1e-6;
constexpr long long kMostCommandsBehind = 1'000'000;  ///< an error; whoever mends it looks again
constexpr int kMostMet = 1000;                        ///< errors in all, those in loops each time
constexpr std::size_t kMostErrors = 100;              ///< of a run; somebody mends the first ones first
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

  /// `machine_read`: the program has read a packet before this command.
  void operator()(const Command& command, bool machine_read) {
    ++report_.commands;
    machine_read_ = machine_read;
    line_ = command.line;
    file_ = command.file;
    std::visit([this](const auto& what) { take(what); }, command.what);
  }

  /// Where the first line that leaves the travel of this axis goes.
  double outside_value(std::size_t axis) const { return outside_value_[axis]; }
  /// The program had read a packet before: the machine decides whether it goes there.
  bool outside_by_machine(std::size_t axis) const { return outside_by_machine_[axis]; }

 private:
  template <typename Other>
  void take(const Other&) {}
  void take(const Wait&) { ++report_.waits; }
  void take(const Dwell& dwell) { report_.dwell_seconds += dwell.seconds; }
  void take(const Spindle&) { ++report_.functions; }
  void take(const MFunction&) { ++report_.functions; }
  void take(const Tool& tool) {
    if (!tool.activate) ++report_.functions;
    auto known = std::find_if(report_.tools.begin(), report_.tools.end(), [&](const auto& t) {
      return t.number == tool.number && t.corrector == tool.corrector;
    });
    if (known == report_.tools.end())
      known = report_.tools.insert(known, {tool.number, tool.corrector, line_, 0});
    ++known->calls;
  }
  void take(const Rapid& rapid) { go(rapid.to); }
  void take(const Line& line) {
    double square = 0.0;
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) square += std::pow(line.to[a] - position_[a], 2);
    report_.path_mm += std::sqrt(square);
    go(line.to);
  }
  void take(const Arc& arc) {
    const auto a1 = at(arc.axis1), a2 = at(arc.axis2);
    const double radius = std::hypot(position_[a1] - arc.center1, position_[a2] - arc.center2);
    double square = std::pow(arc.sweep_deg * kDegree * radius, 2);
    for (std::size_t a = 0; a < machine_.axes.size(); ++a)
      if (a != a1 && a != a2) square += std::pow(arc.to[a] - position_[a], 2);
    report_.path_mm += std::sqrt(square);
    const Box box = extent({position_[a1], position_[a2]}, {arc.to[a1], arc.to[a2]},
                           {arc.center1, arc.center2}, arc.sweep_deg);
    reach(a1, box.low.x), reach(a1, box.high.x), reach(a2, box.low.y), reach(a2, box.high.y);
    go(arc.to);
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
    outside_value_[axis] = value;
    outside_by_machine_[axis] = machine_read_;
  }

  void go(const Position& to) {
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) reach(a, to[a]);
    position_ = to;
  }

  const MachineModel& machine_;
  CheckReport& report_;
  Position position_;
  int line_ = 0, file_ = 0;
  Position outside_value_{};
  std::array<bool, image::kMaxAxes> outside_by_machine_{};
  bool machine_read_ = false;
};

MachineModel without_travel(MachineModel machine) {
  for (auto& axis : machine.axes) {
    axis.travel_min = -kOpenTravel;
    axis.travel_max = kOpenTravel;
  }
  return machine;
}

/// The first line of each axis that leaves its travel.
void add_travel(CheckReport& report, const Interpreter& interpreter, const MachineModel& machine,
                const Survey& survey) {
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const CheckReport::Extent& extent = report.extents[a];
    if (extent.outside_line == 0) continue;
    const double value = survey.outside_value(a);
    const double limit = value > extent.travel_max ? extent.travel_max : extent.travel_min;
    report.findings.push_back(
        {text::Severity::error, interpreter.path(extent.outside_file), extent.outside_line,
         interpreter.column(extent.outside_file, extent.outside_line, static_cast<int>(a)),
         &entry(Fault::travel),
         outside_arguments(machine.axes[a].letter, machine.axes[a].diameter, value, limit)});
    if (survey.outside_by_machine(a)) report.by_machine.push_back(report.findings.size() - 1);
  }
}

/// What a dry run meets: each place once, and no error that only follows from a block that was passed over.
class ErrorsOfRun {
 public:
  ErrorsOfRun(CheckReport& report, const Interpreter& interpreter)
      : report_(report), interpreter_(interpreter) {}

  /// Commands since the first error.
  long long commands_behind() const { return behind_; }
  void moves(const Command& command) {
    if (met_ > 0) ++behind_;
    if (std::holds_alternative<Rapid>(command.what) || std::holds_alternative<Line>(command.what) ||
        std::holds_alternative<Arc>(command.what))
      off_place_ = false;
  }
  bool full() const { return found_.size() >= kMostErrors; }
  bool none() const { return met_ == 0; }
  /// False: nothing can follow.
  bool take(const text::Finding& f) {
    const bool of_first = lacks_told_feed(f);
    // A new place of it is no pass of a loop.
    if (!of_first || !without_feed_.emplace(f.file, f.line).second) ++met_;
    const bool stuck = interpreter_.executed() == executed_ && same(f, last_);
    executed_ = interpreter_.executed();
    last_ = f;
    const bool follows = !found_.empty() && (is(f, Fault::block_limit) || is(f, Fault::endless) ||
                                             (off_place_ && about_the_start(f)));
    off_place_ = true;
    const auto told = [&f](const text::Finding& other) { return same(f, other); };
    const bool new_place =
        std::none_of(found_.begin(), found_.end(), [&](const Met& m) { return told(m.finding); }) &&
        std::none_of(report_.findings.begin(), report_.findings.end(), told);
    if (new_place && !follows && !of_first) {
      const bool without_end = is(f, Fault::block_limit);
      found_.push_back({f, interpreter_.machine_read() && !without_end});
      // It may be meant to go on until somebody stops it.
      if (without_end) found_.back().finding.severity = text::Severity::warning;
    }
    return !stuck && !full() && met_ < kMostMet;
  }
  /// Into the report, behind what stands there.
  void tell() {
    for (const Met& m : found_) {
      report_.findings.push_back(m.finding);
      if (m.by_machine) report_.by_machine.push_back(report_.findings.size() - 1);
      if (!without_feed_.empty() && is(m.finding, Fault::feed_missing)) tell_blocks_without_feed();
    }
  }

 private:
  struct Met {
    text::Finding finding;
    bool by_machine;
  };
  /// One F mends it in every block, so it is told of the first.
  bool lacks_told_feed(const text::Finding& f) const {
    return is(f, Fault::feed_missing) && std::any_of(found_.begin(), found_.end(), [&](const Met& m) {
             return is(m.finding, Fault::feed_missing) && !same(m.finding, f);
           });
  }
  void tell_blocks_without_feed() {
    const auto file = without_feed_.begin()->first;
    const auto line = without_feed_.begin()->second;
    const auto in_file = [&file](const auto& place) { return place.first == file; };
    const auto end = std::find_if_not(without_feed_.begin(), without_feed_.end(), in_file);
    report_.findings.push_back(
        {text::Severity::warning,
         file,
         line,
         1,
         &entry(Fault::feed_missing_more),
         {std::to_string(without_feed_.size()), std::to_string(std::prev(end)->second)}});
  }
  /// A language may add its own number to the id.
  static bool is(const text::Finding& f, Fault fault) { return f.entry->id.starts_with(entry(fault).id); }
  static bool same(const text::Finding& a, const text::Finding& b) {
    return a.file == b.file && a.line == b.line && a.entry == b.entry;
  }
  /// An arc says so when it begins elsewhere than its block means.
  static bool about_the_start(const text::Finding& f) {
    return is(f, Fault::not_congruent) || is(f, Fault::arc_full_by_radius) || is(f, Fault::arc_too_small) ||
           is(f, Fault::arc_zero);
  }

  CheckReport& report_;
  const Interpreter& interpreter_;
  std::vector<Met> found_;
  std::set<std::pair<std::string, int>> without_feed_;  ///< further places of it: file, line
  text::Finding last_;
  long long executed_ = -1, behind_ = 0;
  int met_ = 0;
  bool off_place_ = false;  ///< a block was passed over and nothing has moved since
};

}  // namespace

bool CheckReport::good() const {
  return finished && std::none_of(findings.begin(), findings.end(),
                                  [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

CheckReport check_program(std::string_view dialect, const MachineModel& machine, const Tables& tables,
                          const std::string& file_name, const ProgramText& text, const ProgramLoader& loader,
                          const Position& start, const CommandCheck& also, int process) {
  CheckReport report;
  Interpreter interpreter(dialect, without_travel(machine), tables, file_name, text, loader, start, process);
  report.findings = interpreter.findings();
  report.of_run = report.findings.size();
  report.blocks = interpreter.block_count();
  Survey survey(machine, start, report);
  ErrorsOfRun errors(report, interpreter);
  const auto on_command = [&](const Command& command) {
    survey(command, interpreter.machine_read());
    errors.moves(command);
    if (errors.commands_behind() > kMostCommandsBehind) return false;
    std::optional<text::Finding> refused;
    if (also && !errors.full()) refused = also(command);
    if (!refused) return true;
    refused->file = interpreter.path(command.file);
    refused->line = command.line;
    refused->column = interpreter.column(command.file, command.line, -1);
    return errors.take(*refused);
  };
  const auto on_error = [&](const text::Finding& error) { return errors.take(error); };
  const auto error = run_dry(interpreter, on_command, kDryRunBlocks + report.blocks, on_error);
  if (error && error->entry == &entry(Fault::block_limit)) errors.take(*error);
  report.executed = interpreter.executed();
  report.files = interpreter.files();
  report.finished = !error && errors.none();
  const std::vector<text::Finding>& warnings = interpreter.warnings();
  report.findings.insert(report.findings.end(), warnings.begin(), warnings.end());
  add_travel(report, interpreter, machine, survey);
  errors.tell();
  return report;
}

}  // namespace servogate::program
