// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/track/window.hpp"

namespace servogate::path {

void Window::stage(const Entry& entry) noexcept {
  at(staged_++) = entry;
  if (!entry.more) last_ = staged_;
}

bool Window::revise(const Span& update) noexcept {
  // Numbers rise along the window, and a marker carries the number of the span before it: the first entry
  // that is not below is the span, if it is still there.
  std::uint64_t low = first_, high = last_;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (at(middle).span.number < update.number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == last_ || at(low).kind != Entry::Kind::span || at(low).span.number != update.number) return false;
  Span& span = at(low).span;
  span.terms = update.terms;
  span.final = update.final;
  span.stop = update.stop;
  span.confirm = update.confirm;
  return low == first_;
}

}  // namespace servogate::path
