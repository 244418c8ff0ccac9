// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"

namespace servogate::program::nc110 {

/// M, S, T and H may not stand in a motion block of a continuous profile. Source: specification A 13.2,
/// A 6.5.
void profile(const Execution& run, const BlockWords& words) {
  const State& state = run.state();
  if (state.modes.motion == Function::rapid || state.modes.corner == Function::exact) return;
  const auto refuse = [&](const Word& word) {
    fail(Wrong::function_in_profile, word.column, {word_text(run.dialect(), run.block(), word)});
  };
  for (const Word* word : {words.speed, words.tool, words.h})
    if (word != nullptr) refuse(*word);
  for (int i = 0; i < words.m_count; ++i) {
    const MRule* rule = run.dialect().find_m(words.m_code[static_cast<std::size_t>(i)]);
    const bool allowed = rule != nullptr && rule->in_profile && !state.motion.profile_open;
    if (!allowed) refuse(*words.m[static_cast<std::size_t>(i)]);
  }
}

}  // namespace servogate::program::nc110
