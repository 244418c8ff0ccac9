// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/pdo/pdo_watch.hpp"

namespace servogate::canopen {
namespace {

/// A timer of the node is not in step with our cycle.
std::int64_t expected_every(const PdoWanted& pdo, image::Nanoseconds cycle_ns) noexcept {
  if (!pdo.used()) return 0;
  const std::int64_t cycles = cycles_between(pdo, cycle_ns);
  if (pdo.cyclic()) return cycles;
  return pdo.event_ms > 0 ? cycles + 2 : 0;
}

}  // namespace

PdoWatch::PdoWatch(const std::array<PdoWanted, 4>& tpdos, image::Nanoseconds cycle_ns,
                   std::int64_t max_missed) noexcept
    : max_missed_(max_missed) {
  for (std::size_t i = 0; i < watches_.size(); ++i) watches_[i].every = expected_every(tpdos[i], cycle_ns);
  restart();
}

void PdoWatch::restart() noexcept {
  for (Watch& w : watches_) w.cycles = w.every > 0 ? w.every - 1 : 0;
  overdue_ = {};
}

bool PdoWatch::step(const ProcessData& data) noexcept {
  overdue_ = {};
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& w = watches_[i];
    if (w.every == 0) continue;
    w.cycles = data.fresh({static_cast<std::int8_t>(i), 0, 8}) ? 0 : w.cycles + 1;
    if (w.cycles < w.every) continue;
    const Overdue found{static_cast<int>(i) + 1, w.cycles / w.every, w.cycles, max_missed_ * w.every};
    const bool nearer = found.limit - found.cycles < overdue_.limit - overdue_.cycles;
    if (overdue_.number == 0 || nearer) overdue_ = found;
  }
  return overdue_.number == 0;
}

}  // namespace servogate::canopen
