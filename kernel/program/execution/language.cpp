// SPDX-License-Identifier: Apache-2.0
// Programs of more than one language: a block switches, and a subprogram may be written in another one.
#include <utility>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/execution/own_codes.hpp"

namespace servogate::program {

void Execution::take_language(const Dialect& language) {
  if (data_.language == &language) return;
  data_.language = &language;
  data_.extended = with_own_codes(language, machine_);
  data_.dialect = data_.extended ? data_.extended.get() : &language;
  spoken_ = *data_.dialect;
}

/// Before a block is read: what the one before it, a call or a return has changed.
void Execution::follow_language() {
  const std::size_t depth = state_.flow.calls.size();
  if (const Dialect* next = std::exchange(data_.next_language, nullptr); next != nullptr)
    take_language(*next);
  while (data_.callers.size() > depth) {
    const ExecutionData::Caller caller = std::move(data_.callers.back());
    data_.callers.pop_back();
    take_language(*caller.language);
    if (caller.modes) state_.modes = *caller.modes;
  }
  if (data_.callers.size() == depth) return;
  while (data_.callers.size() < depth) data_.callers.push_back({data_.language, std::nullopt});
  if (const Dialect* own = dialect_.speaks(machine_, flow_.source().line(data_.line), true); own != nullptr)
    take_language(*own);
}

void Execution::keep_modes() {
  if (!data_.callers.empty()) data_.callers.back().modes = state_.modes;
}

}  // namespace servogate::program
