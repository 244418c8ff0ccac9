// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/homing/switch_edge.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {

void SwitchEdge::sample(image::Nanoseconds t, std::int64_t counts) noexcept {
  samples_[sampled_++ % kSamples] = {t, counts};
  for (std::size_t n = 0; n < changed_; ++n)
    if (!changes_[n].counts) changes_[n].counts = at(changes_[n].begin);
}

void SwitchEdge::edge(bool level, image::Nanoseconds t) noexcept {
  if (changed_ > 0 && t - changes_[0].last <= kBounce) {
    changes_[0].last = t;
    changes_[0].level = level;
    return;
  }
  std::move_backward(changes_.begin(), changes_.end() - 1, changes_.end());
  changes_[0] = {t, t, level, at(t)};
  changed_ = std::min(changed_ + 1, kChanges);
}

/// Between the samples around t, newest first.
std::optional<std::int64_t> SwitchEdge::at(image::Nanoseconds t) const noexcept {
  const std::size_t kept = std::min(sampled_, kSamples);
  for (std::size_t ago = 1; ago < kept; ++ago) {
    const Sample& behind = samples_[(sampled_ - ago) % kSamples];
    const Sample& before = samples_[(sampled_ - ago - 1) % kSamples];
    if (t > behind.t) return std::nullopt;  // the position behind it is still to come
    if (t < before.t) continue;
    const double share = static_cast<double>(t - before.t) / static_cast<double>(behind.t - before.t);
    return before.counts + std::llround(share * static_cast<double>(behind.counts - before.counts));
  }
  return std::nullopt;
}

std::optional<std::int64_t> SwitchEdge::counts() const noexcept {
  const Change* found = nullptr;
  for (std::size_t n = 0; n < changed_; ++n) {
    const Change& change = changes_[n];
    if (change.level != level_ || change.begin > seen_ns_ + kLate) continue;
    found = &change;
    if (change.begin <= seen_ns_) break;
  }
  return found != nullptr ? found->counts : std::nullopt;
}

}  // namespace servogate::axis
