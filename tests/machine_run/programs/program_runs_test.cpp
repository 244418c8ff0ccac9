// SPDX-License-Identifier: Apache-2.0
// Programs of the language's own cases on the example mill and lathe, in virtual time: the axis set-points
// come by every place that the canonical commands name, in their order, and end where they end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "gateway/control/compose/program/program_model.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"
#include "machine/load.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::machine_run {
namespace {

using program::Command;
using program::Position;

constexpr double kTolerance = 0.02;    ///< mm: the contour tolerance of the examples, and half of it
constexpr double kMostSeconds = 30.0;  ///< of one program: all of them are to take little
constexpr int kMostPrograms = 80;

/// What a case gives on a machine from where its axes stand; empty: it is none for this machine.
struct Plan {
  std::vector<Position> places;  ///< ends of its motions
  Position end{};
};

/// The logic of the machine would have a part in it; `turns`: it does what the spindle is told.
bool cannot_run(const Command& command, bool turns) {
  if (const auto* m = std::get_if<program::MFunction>(&command.what))
    return m->code != 2 && m->code != 30 && !(turns && m->code >= 3 && m->code <= 5);
  if (std::holds_alternative<program::Spindle>(command.what)) return !turns;
  return std::holds_alternative<program::Wait>(command.what) ||
         std::holds_alternative<program::Stop>(command.what) ||
         std::holds_alternative<program::Probe>(command.what) ||
         std::holds_alternative<program::Thread>(command.what) ||
         std::holds_alternative<program::SpindleMark>(command.what) ||
         std::holds_alternative<program::ProcessOrder>(command.what) ||
         std::holds_alternative<program::HFunction>(command.what) ||
         std::holds_alternative<program::Tool>(command.what);
}

/// mm/min of a linear or circular motion.
double per_minute(const program::Feed& feed, double rpm) {
  return feed.unit == program::FeedUnit::mm_per_rev ? feed.value * rpm : feed.value;
}

/// Seconds that a motion takes at least.
double least_seconds(const Command& command, const Position& from, const Position& to, double rpm) {
  double square = 0.0;
  for (std::size_t a = 0; a < from.size(); ++a) square += std::pow(to[a] - from[a], 2);
  double length = std::sqrt(square);
  if (const auto* arc = std::get_if<program::Arc>(&command.what)) {
    length += std::abs(arc->sweep_deg) * 0.0174533 *
              std::hypot(from[arc->axis1] - arc->center1, from[arc->axis2] - arc->center2);
    return arc->feed.unit != program::FeedUnit::inverse_time ? length * 60.0 / per_minute(arc->feed, rpm)
                                                             : 60.0 / arc->feed.value;
  }
  if (const auto* line = std::get_if<program::Line>(&command.what))
    return line->feed.unit != program::FeedUnit::inverse_time ? length * 60.0 / per_minute(line->feed, rpm)
                                                              : 60.0 / line->feed.value;
  return 0.5;
}

std::optional<Plan> plan_of(const std::string& language, const program::tests::CaseFile& c,
                            const program::MachineModel& model, const Position& start, bool turns) {
  const program::ProgramLoader none;
  if (!c.subprograms.empty()) return std::nullopt;
  const program::CheckReport report =
      program::check_program(language, model, {}, "p.nc", c.program, none, start);
  if (!report.findings.empty() || !report.finished) return std::nullopt;
  Plan plan;
  Position at = start;
  double seconds = 0.0, rpm = 0.0;
  bool good = true;
  program::Interpreter interpreter(language, model, {}, "p.nc", c.program, none, start);
  const auto on_command = [&](const Command& command) {
    good = good && !cannot_run(command, turns);
    if (const auto* spindle = std::get_if<program::Spindle>(&command.what)) {
      const bool runs =
          spindle->mode == program::SpindleMode::cw || spindle->mode == program::SpindleMode::ccw;
      rpm = runs ? spindle->speed : 0.0;
      good = good && !spindle->surface_speed;
      seconds += 1.0;
    }
    const auto drivable = [rpm](const program::Feed& feed) {
      return feed.unit != program::FeedUnit::mm_per_rev || rpm > 0.0;
    };
    Position to = at;
    if (const auto* rapid = std::get_if<program::Rapid>(&command.what)) to = rapid->to;
    if (const auto* line = std::get_if<program::Line>(&command.what)) {
      to = line->to;
      good = good && drivable(line->feed);
    }
    if (const auto* arc = std::get_if<program::Arc>(&command.what)) {
      to = arc->to;
      good = good && drivable(arc->feed);
    }
    if (const auto* dwell = std::get_if<program::Dwell>(&command.what)) seconds += dwell->seconds;
    if (to != at || std::holds_alternative<program::Arc>(command.what)) {
      seconds += least_seconds(command, at, to, rpm);
      plan.places.push_back(to);
      at = to;
    }
    return good && seconds < kMostSeconds;
  };
  if (program::run_dry(interpreter, on_command, 10'000)) return std::nullopt;
  if (!good || seconds >= kMostSeconds || plan.places.empty()) return std::nullopt;
  plan.end = at;
  return plan;
}

double from_way(const Position& p, const Position& a, const Position& b, std::size_t axes) {
  double square = 0.0, along = 0.0;
  for (std::size_t i = 0; i < axes; ++i) {
    square += (b[i] - a[i]) * (b[i] - a[i]);
    along += (p[i] - a[i]) * (b[i] - a[i]);
  }
  const double s = square == 0.0 ? 0.0 : std::clamp(along / square, 0.0, 1.0);
  double off = 0.0;
  for (std::size_t i = 0; i < axes; ++i) off += std::pow(p[i] - a[i] - s * (b[i] - a[i]), 2);
  return std::sqrt(off);
}

/// Programs of another language than the example's own.
struct Spoken {
  std::string folder;  ///< of the cases, where it is not named as the language
  std::vector<std::string> power_on;
  program::MachineModel::Kind kind = program::MachineModel::Kind::by_axes;
  bool turns = false;  ///< the spindle may be told to turn
};

/// How many of the cases ran on this machine.
int run_all(const std::string& example, const std::string& language, const std::string& axes_of_cases,
            std::set<std::string>& done, const Spoken& spoken = {}) {
  const machine::LoadResult loaded = machine::load(source("examples/" + example + "/machine.toml"));
  Mill mill(loaded, "");
  program::MachineModel model = gateway::program_model(loaded.machine, 0);
  if (!spoken.power_on.empty()) {
    model.power_on = spoken.power_on;
    model.variables.clear();
    model.kind = spoken.kind;
  }
  const auto axes = static_cast<std::size_t>(model.axis_count());
  if (!mill.make_ready()) {
    ADD_FAILURE() << example << ": " << mill.alarm_list();
    return 0;
  }
  const auto here = [&] {
    Position p{};
    for (std::size_t i = 0; i < axes; ++i) p[i] = mill.image().axes[i].command;
    return p;
  };
  int count = 0;
  for (const std::string& path :
       program::tests::case_paths(servogate::tests::source_dir() + "/tests/program/" +
                                  (spoken.folder.empty() ? language : spoken.folder))) {
    const program::tests::CaseFile c = program::tests::read_case(path);
    std::string letters;
    for (const auto& axis : c.machine.axes) letters += axis.letter + (axis.diameter ? "d" : "");
    if (!letters.starts_with(axes_of_cases) || !c.errors.empty() || !c.findings.empty() ||
        count == kMostPrograms)
      continue;
    const Position start = here();
    const auto plan = plan_of(language, c, model, start, spoken.turns);
    if (!plan) continue;
    mill.control().process(0).load([&](const Position& at) {
      return program::Interpreter(language, model, {}, c.name + ".nc", c.program, {}, at);
    });
    const auto free = [&] {
      return mill.standing() &&
             std::all_of(mill.image().axes.begin(), mill.image().axes.begin() + axes,
                         [](const auto& a) { return a.owner == image::AxisOwner::none && a.in_position; });
    };
    EXPECT_TRUE(mill.until(free, 10.0)) << c.name << " begins from rest on the " << example;
    if (const cycle::Refusal refusal = mill.ask(image::RequestKind::start); refusal != cycle::Refusal::none) {
      ADD_FAILURE() << c.name << " does not start on the " << example << ": refusal "
                    << static_cast<int>(refusal) << ", alarms " << mill.alarm_list();
      continue;
    }
    std::size_t next = 0;
    Position before = start;
    mill.after_cycle = [&] {
      const Position now = here();
      while (next < plan->places.size() && from_way(plan->places[next], before, now, axes) <= kTolerance)
        ++next;
      before = now;
    };
    const bool ended = mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 60.0);
    mill.after_cycle = nullptr;
    if (!ended) mill.ask(image::RequestKind::reset);
    EXPECT_TRUE(ended) << c.name << " on the " << example << ": " << mill.alarm_list();
    EXPECT_EQ(next, plan->places.size()) << c.name << " on the " << example << " missed a place";
    for (std::size_t i = 0; i < axes; ++i)
      EXPECT_NEAR(here()[i], plan->end[i], 1e-6) << c.name << ", axis " << i;
    done.insert(c.name);
    ++count;
  }
  EXPECT_EQ(mill.judge().verdict(), "") << example;
  return count;
}

TEST(ProgramRuns, of_sixty_cases_lead_the_set_points_of_mill_and_lathe_by_every_place_within_the_limits) {
  std::set<std::string> done;
  const int mill = run_all("mill", "nc110", "XYZ", done), lathe = run_all("lathe", "nc110", "XdZ", done);
  std::printf("%d programs on the mill, %d on the lathe, %zu different\n", mill, lathe, done.size());
  EXPECT_GE(done.size(), 60u);
  EXPECT_GE(lathe, 6);
}

TEST(ProgramRuns, of_Fenix_lead_the_set_points_of_its_lathe_by_every_place_within_the_limits) {
  std::set<std::string> done;
  const int lathe = run_all("fenix-shaft", "fenix", "XdZ", done);
  std::printf("%d programs of Fenix\n", lathe);
  EXPECT_GE(lathe, 40);
}

/// Cases of the Siemens mode are none on a machine that powers on in the ISO dialect: what they say is
/// refused.
TEST(ProgramRuns,
     of_the_ISO_dialect_lead_the_set_points_of_a_mill_and_a_lathe_by_every_place_within_the_limits) {
  std::set<std::string> done;
  Spoken on_mill, on_lathe;
  on_mill.folder = on_lathe.folder = "sinumerik";
  on_lathe.power_on = {"G291"};
  on_lathe.kind = program::MachineModel::Kind::turning;
  on_lathe.turns = true;
  const int mill = run_all("iso-flange", "sinumerik-808d", "XYZ", done, on_mill);
  const int lathe = run_all("lathe", "sinumerik-808d", "XdZ", done, on_lathe);
  std::printf("%d programs of the ISO dialect on the mill, %d on the lathe, %zu different\n", mill, lathe,
              done.size());
  EXPECT_GE(done.size(), 40u);
  EXPECT_GE(lathe, 6);
}

}  // namespace
}  // namespace servogate::machine_run
