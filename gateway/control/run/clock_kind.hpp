// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace servogate::gateway {

/// How time passes.
enum class ClockKind { unset, virtual_time, realtime, realtime_best_effort };

/// "virtual", "realtime", "realtime=best-effort", as reports have it; empty: unset.
constexpr std::string_view name_of(ClockKind clock) noexcept {
  switch (clock) {
    case ClockKind::virtual_time:
      return "virtual";
    case ClockKind::realtime:
      return "realtime";
    case ClockKind::realtime_best_effort:
      return "realtime=best-effort";
    case ClockKind::unset:
      break;
  }
  return {};
}

}  // namespace servogate::gateway
