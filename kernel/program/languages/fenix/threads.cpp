// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// G31 and G32: threads by the turns of the spindle (specification 13).
namespace servogate::program::fenix {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

constexpr double kFlank = 28.0;  ///< degrees, of metric threads
constexpr int kMostPasses = 10'000;

/// A thread before its passes: programmed coordinates, mm, of a diameter axis radii.
struct Thread1 {
  int along = 0, across = 0;
  double from_along = 0.0, from_across = 0.0, to_along = 0.0, to_across = 0.0;
  double lead = 0.0;  ///< along the main axis
};

double end_of(const Execution& run, const BlockWords& words, int axis) {
  const Word* word = words.axis[at(axis)];
  const double from = run.state().frames.programmed[at(axis)];
  if (word == nullptr) return from;
  const double value = run.numbers().length(axis, word->value);
  return run.state().modes.dimension == Function::incremental ? from + value : value;
}

Thread1 thread_of(const Execution& run, const BlockWords& words, const Arguments& arguments) {
  const FramesState& frames = run.state().frames;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[at(a)] != nullptr && a != frames.axis1 && a != frames.axis2)
      fail(Fault::word_without_function, words.axis[at(a)]->column,
           {word_text(run.dialect(), run.block(), *words.axis[at(a)])});
  if (run.machine().spindles == 0) fail(Fault::no_spindle, arguments.column(), {arguments.name()});
  if (words.feed == nullptr) fail(Wrong::thread_feed, arguments.column());
  Thread1 thread;
  const double z = end_of(run, words, frames.axis1) - frames.programmed[at(frames.axis1)];
  const double x = end_of(run, words, frames.axis2) - frames.programmed[at(frames.axis2)];
  if (std::abs(std::abs(z) - std::abs(x)) < 1e-9)
    fail(Wrong::thread_equal, arguments.column(), {text::number(std::abs(z), 4)});
  const bool along_z = std::abs(z) > std::abs(x);
  thread.along = along_z ? frames.axis1 : frames.axis2;
  thread.across = along_z ? frames.axis2 : frames.axis1;
  thread.from_along = frames.programmed[at(thread.along)];
  thread.from_across = frames.programmed[at(thread.across)];
  thread.to_along = end_of(run, words, thread.along);
  thread.to_across = end_of(run, words, thread.across);
  thread.lead = run.numbers().resolve(words.feed->value);
  return thread;
}

/// The main axis has to keep up with the fastest turn that the spindle may take.
void check_speed(const Execution& run, const Thread1& thread, const Arguments& arguments) {
  const double rapid = run.machine().axes[at(thread.along)].rapid * 60.0;
  const double deviation = run.machine().variable("P2622", 0.0);
  const double most = rapid * (100.0 - deviation) / (100.0 * thread.lead);
  if (rapid > 0.0 && run.state().modes.speed > most)
    fail(Wrong::thread_speed, arguments.column(),
         {text::number(run.state().modes.speed), text::number(std::floor(most))});
}

/// From the start to the depth `across` and `shift` further along, the thread, and back.
void cut(Execution& run, const Thread1& thread, double across, double shift, double taper, double angle) {
  const double forward = thread.to_along < thread.from_along ? -1.0 : 1.0;
  Position place = run.state().frames.programmed;
  place[at(thread.along)] = thread.from_along + forward * shift;
  run.motion().go(place, true);
  place[at(thread.across)] = across;
  run.motion().go(place, true);
  place[at(thread.along)] = thread.to_along;
  place[at(thread.across)] = across + taper;
  const double way = std::abs(thread.to_along - thread.from_along) - shift;
  run.motion().thread(place, thread.lead * way / std::hypot(way, taper), angle);
  place[at(thread.across)] = thread.from_across;
  run.motion().go(place, true);
  place[at(thread.along)] = thread.from_along;
  run.motion().go(place, true);
}

}  // namespace

void thread_once(Execution& run, const BlockWords& words) {
  forget_profile(run.state());
  const Arguments arguments(run, words);
  run.frames().need_plane(arguments.column());
  run.refuse_words_but_axes(words);
  arguments.at_most(2);
  const Thread1 thread = thread_of(run, words, arguments);
  check_speed(run, thread, arguments);
  run.motion().end_profile();
  const bool diameter =
      run.machine().axes[at(thread.across)].diameter && run.state().modes.across == Function::diameter;
  cut(run, thread, thread.to_across, 0.0, arguments.number(0) / (diameter ? 2.0 : 1.0), arguments.number(1));
}

/// Passes of equal depth along the flank; each start of a thread with several has all of them.
void thread_passes(Execution& run, const BlockWords& words) {
  forget_profile(run.state());
  const Arguments arguments(run, words);
  run.frames().need_plane(arguments.column());
  run.refuse_words_but_axes(words);
  arguments.at_most(5);
  const Thread1 thread = thread_of(run, words, arguments);
  check_speed(run, thread, arguments);
  run.motion().end_profile();
  const double depth = arguments.positive(0, 0.0);
  const double pass = arguments.given(0) ? arguments.positive(1, depth, true) : 0.0;
  const double in = thread.to_across < thread.from_across ? -1.0 : 1.0;
  const double taper = -in * arguments.number(2) / 2.0;  // + leads out of the thread
  const double flank = tan_deg(arguments.positive(4, kFlank));
  const int starts = static_cast<int>(arguments.positive(3, 1.0, true));
  const int passes = pass > 0.0 ? static_cast<int>(std::ceil(depth / pass - 1e-9)) : 1;
  if (passes > kMostPasses || starts > kMostPasses || depth / std::max(pass, 1e-9) > kMostPasses)
    fail(Wrong::passes, arguments.column(), {arguments.name(), std::to_string(kMostPasses)});
  for (int start = 0; start < starts; ++start)
    for (int i = 1; i <= passes; ++i) {
      const double here = std::min(i * pass, depth);
      cut(run, thread, thread.to_across - in * (depth - here), pass > 0.0 ? here * flank : 0.0, taper,
          360.0 / starts * start);
    }
}

}  // namespace servogate::program::fenix
