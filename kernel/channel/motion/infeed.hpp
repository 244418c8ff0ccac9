// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "kernel/path/shape/element.hpp"

namespace servogate::channel {

/// From which side each axis came to a thread, by its last move: an outer and an inner one are left to
/// opposite sides. Moves below 0.2 mm (taking up backlash) say nothing. Not real-time safe.
class Infeed {
 public:
  explicit Infeed(const path::Config& config) : config_(config) {}

  void restart() { side_ = {}; }
  /// A motion that is no thread.
  void take(const path::Vector& from, const path::Vector& to) {
    for (std::size_t i = 0; i < side_.size(); ++i) {
      const double d = to[i] - from[i];
      if (config_.threads.retract[i] != 0.0 && std::abs(d) >= kLeast) side_[i] = d > 0.0 ? 1 : -1;
    }
  }
  /// Which axes leave the thread against their sign, and which not at all: those that have not come to it.
  void put(path::Lock& lock) const {
    if (!config_.threads.by_infeed) return;
    for (std::size_t i = 0; i < side_.size(); ++i) {
      const double declared = config_.threads.retract[i];
      if (declared == 0.0) continue;
      const auto bit = static_cast<std::uint16_t>(1u << i);
      if (side_[i] == 0) lock.stays = static_cast<std::uint16_t>(lock.stays | bit);
      if (side_[i] * declared > 0.0) lock.against = static_cast<std::uint16_t>(lock.against | bit);
    }
  }

 private:
  static constexpr double kLeast = 0.2;  // mm
  path::Config config_;
  std::array<int, path::kMaxAxes> side_{};
};

}  // namespace servogate::channel
