// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"

namespace servogate::program::nc110 {
namespace {

/// Of the axis with the longest way, along which the pitch counts.
double longest_way(const Execution& run, const Position& to) {
  double longest = 0.0;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    longest = std::max(longest, std::abs(to[static_cast<std::size_t>(a)] -
                                         run.state().frames.machine[static_cast<std::size_t>(a)]));
  return longest;
}

void tell_alias(Execution& run) {
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.g == nullptr || word.g->number != 34) continue;
    Written place = run.capability().written(word.column);
    run.capability().warn(place, entry(Wrong::thread_alias), {});
  }
}

}  // namespace

void thread(Execution& run, const BlockWords& words) {
  const int column = static_cast<int>(run.block().body) + 1;
  for (const Word* word : {words.centre2, words.radius2, words.time})
    if (word != nullptr)
      fail(Fault::word_without_function, word->column, {word_text(run.dialect(), run.block(), *word)});
  if (run.machine().spindles == 0) fail(Fault::no_spindle, column, {"G33"});
  tell_alias(run);
  constexpr int kAlong = 0;  // pitches are lengths, whatever the axis
  Thread thread;
  thread.lead = words.pitch == nullptr ? 0.0 : run.numbers().length(kAlong, words.pitch->value, false);
  if (!(thread.lead > 0.0)) fail(Wrong::thread_lead, words.pitch == nullptr ? column : words.pitch->column);
  if (words.centre1 != nullptr)
    thread.lead_change = run.numbers().length(kAlong, words.centre1->value, false);
  if (words.radius != nullptr) thread.start_angle_deg = run.numbers().resolve(words.radius->value);
  thread.to = run.motion().target_of(words);
  const double way = longest_way(run, thread.to);
  if (thread.lead * thread.lead + 2.0 * thread.lead_change * way <= 0.0)
    fail(Wrong::thread_ends, words.centre1->column,
         {text::number(-thread.lead * thread.lead / (2.0 * way), 4)});
  run.motion().thread(thread);
}

}  // namespace servogate::program::nc110
